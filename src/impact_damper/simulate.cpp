#include "impact_damper/simulate.hpp"

#include "impact_damper/engines/checked.hpp"
#include "impact_damper/engines/recorded.hpp"

namespace impact_damper {
namespace {

Outcome recorded(const Checked& run, const Exact&, Recorder& recorder) {
  if (has_components(run.scene())) return run_exact_with_components<double>(run, recorder);
  return has_one_damper(run.scene()) ? run_exact<double>(run, recorder)
                                     : run_exact_dampers<double>(run, recorder);
}

Outcome recorded(const Checked& run, const Restitution&, Recorder& recorder) {
  if (has_components(run.scene())) return run_restitution_with_components<double>(run, recorder);
  return has_one_damper(run.scene()) ? run_restitution<double>(run, recorder)
                                     : run_restitution_dampers<double>(run, recorder);
}

Outcome recorded(const Checked& run, const Cem&, Recorder& recorder) {
  return has_one_damper(run.scene()) && is_ideal(run.scene()) ? run_cem<double>(run, recorder)
                                                              : run_cem_dampers<double>(run, recorder);
}

}  // namespace

Run simulate(const Scene& scene, const Engine& engine, const Record& record) {
  const Checked run = checked(scene, engine, record);
  Run result;
  result.scene = run.scene();
  result.engine = run.engine();
  Recorder recorder(record, scene.dampers.size());
  const Outcome outcome =
      std::visit([&](const auto& options) { return recorded(run, options, recorder); }, run.engine());
  result.stop_reason = outcome.stop_reason;
  result.end_time = outcome.end_time;
  recorder.finish(result);
  return result;
}

}  // namespace impact_damper
