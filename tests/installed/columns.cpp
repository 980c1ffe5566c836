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

Outcome observed(const Checked& run, const Exact&, OwnRecorder& recorder) {
  return has_one_damper(run.scene()) ? run_exact<double>(run, recorder)
                                     : run_exact_dampers<double>(run, recorder);
}
Outcome observed(const Checked& run, const Restitution&, OwnRecorder& recorder) {
  return has_one_damper(run.scene()) ? run_restitution<double>(run, recorder)
                                     : run_restitution_dampers<double>(run, recorder);
}
Outcome observed(const Checked& run, const Cem&, OwnRecorder& recorder) {
  return has_one_damper(run.scene()) ? run_cem<double>(run, recorder)
                                     : run_cem_dampers<double>(run, recorder);
}

template <class Options>
void write(const Scene& scene, const Options& options) {
  const Record record{.impacts = true, .contacts = true, .energy = true, .history = {{0, 150, 301}}};
  const Checked checked_run = checked(scene, options, record);
  OwnRecorder recorder(record, scene.dampers.size());
  const Outcome outcome = observed(checked_run, options, recorder);
  Run result;
  result.stop_reason = outcome.stop_reason;
  result.end_time = outcome.end_time;
  result.scene = scene;
  result.engine = checked_run.engine();
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
