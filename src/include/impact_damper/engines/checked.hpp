// The one place that decides whether a scene can be run.
#pragma once

#include <variant>
#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

// Conflicts between a scene and an engine's options, each of which is allowed by itself. One entry per
// offending field, of the scene or of the engine, as problems_of(Scene). Both must be free of problems by
// themselves, and the engine complete: without a time step cem is not compared.
std::vector<Problem> incompatibilities_of(const Scene& scene, const Engine& engine);

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

// Throws InvalidArguments if the scene has friction, drag or weight: for the functions of engines that leave
// them out. run_cem_dampers() and run_restitution_with_components() take such scenes.
void require_no_components(const Scene& scene);
// Throws it if walls or the primary spring have laws of their own, too (is_ideal).
void require_ideal(const Scene& scene);

// Returns the scene, and the engine with its options that depend on the scene filled in: the time step of cem
// and the limits of a run (Budget). Throws InvalidArguments with every problem of the scene, the engine, the
// record and their combinations, as simulate() does (simulate.hpp). record: what a Recorder will record; the
// default is for an observer of one's own.
Checked checked(const Scene& scene, const Engine& engine, const Record& record = {.half_cycles = false});

}  // namespace impact_damper
