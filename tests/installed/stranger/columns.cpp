// Runs a scene by an engine that is compiled here, for an observer of this program's own, with the options
// that the installed package gives; writes the run as the project's program does.
//
//   columns ENGINE SCENE
#include <iostream>
#include <string_view>
#include <type_traits>

#include "impact_damper/engines/cem.hpp"
#include "impact_damper/engines/exact.hpp"
#include "impact_damper/engines/exact_dampers.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/engines/restitution.hpp"
#include "impact_damper/engines/restitution_dampers.hpp"
#include "impact_damper/io/run_file.hpp"
#include "impact_damper/io/scene_file.hpp"

namespace impact_damper {
namespace {

// A type that the library has no instance for.
struct OwnRecorder : Recorder {
  using Recorder::Recorder;
};

Outcome run(const Scene& scene, const Exact& options, OwnRecorder& recorder) {
  return has_one_damper(scene) ? run_exact<double>(scene, options, recorder)
                               : run_exact_dampers<double>(scene, options, recorder);
}
Outcome run(const Scene& scene, const Restitution& options, OwnRecorder& recorder) {
  return has_one_damper(scene) ? run_restitution<double>(scene, options, recorder)
                               : run_restitution_dampers<double>(scene, options, recorder);
}
Outcome run(const Scene& scene, const Cem& options, OwnRecorder& recorder) {
  return has_one_damper(scene) ? run_cem<double>(scene, options, recorder)
                               : run_cem_dampers<double>(scene, options, recorder);
}

template <class Options>
void write(const Scene& scene, Options options) {
  options.budget = budget_for(scene, options.budget);
  if constexpr (std::is_same_v<Options, Cem>) options = resolved(scene, options);
  Record record;
  record.impacts = record.contacts = record.energy = true;
  record.history = {{0, 150, 301}};
  OwnRecorder recorder(record, scene.dampers.size());
  const Outcome outcome = run(scene, options, recorder);
  Run result;
  result.stop_reason = outcome.stop_reason;
  result.end_time = outcome.end_time;
  result.scene = scene;
  result.engine = options;
  recorder.finish(result);
  std::cout << run_text(result);
}

}  // namespace
}  // namespace impact_damper

int main(int, char** arguments) {
  const std::string_view engine = arguments[1];
  const impact_damper::Scene scene = impact_damper::read_scene(arguments[2]);
  if (engine == "exact") impact_damper::write(scene, impact_damper::Exact{});
  if (engine == "restitution") impact_damper::write(scene, impact_damper::Restitution{});
  if (engine == "cem") impact_damper::write(scene, impact_damper::Cem{});
}
