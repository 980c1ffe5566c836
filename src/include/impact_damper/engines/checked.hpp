// The one place that decides whether a scene can be run.
#pragma once

#include <variant>

#include "impact_damper/run.hpp"

namespace impact_damper {

// A scene and an engine that are valid and go together, the engine's options complete. Only checked() makes
// one.
class Checked {
 public:
  const Scene& scene() const { return scene_; }
  const Engine& engine() const { return engine_; }
  // Returns the engine's options; the engine must be of this type.
  template <class Options>
  const Options& options() const {
    return std::get<Options>(engine_);
  }

 private:
  friend Checked checked(const Scene& scene, const Engine& engine, const Record& record);
  // By reference: one copy of each, and less code in the module for browsers.
  // NOLINTNEXTLINE(modernize-pass-by-value)
  Checked(const Scene& scene, const Engine& engine) : scene_(scene), engine_(engine) {}

  Scene scene_;
  Engine engine_;
};

// Returns the scene and the engine, whose options that depend on the scene are filled in: the time step of
// cem, and budgets. Throws InvalidArguments, with every problem of the scene, of the engine, of the record or
// of what does not go together, as simulate() does (simulate.hpp). record: what is to be recorded; an
// observer of one's own need not name any.
Checked checked(const Scene& scene, const Engine& engine, const Record& record = {.half_cycles = false});

}  // namespace impact_damper
