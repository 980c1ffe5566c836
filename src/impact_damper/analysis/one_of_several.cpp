#include "impact_damper/analysis/one_of_several.hpp"

namespace impact_damper {
namespace {

std::vector<double> divided(std::vector<double> values, double by) {
  for (double& each : values) each /= by;
  return values;
}

Scene scene_of_damper(const Scene& scene, const SceneDamper& damper) {
  const double c = damper.clearance;
  Scene alone = scene;
  for (double Scene::*const length : {&Scene::x0, &Scene::v0, &Scene::force_amplitude}) alone.*length /= c;
  if (alone.until_amplitude) *alone.until_amplitude /= c;
  alone.dampers = {damper};
  alone.damper().clearance = 1;
  alone.damper().y0 = damper.y0 > c ? 1 + (damper.y0 - c) / c : damper.y0 / c;
  alone.damper().w0 /= c;
  return alone;
}

}  // namespace

Run run_of_damper(const Run& run, std::size_t number) {
  const SceneDamper& damper = run.scene.dampers.at(number);
  const double c = damper.clearance;
  const auto its = static_cast<std::int32_t>(number);
  Run one;
  one.scene = scene_of_damper(run.scene, damper);
  one.engine = run.engine;
  one.stop_reason = run.stop_reason;
  one.end_time = run.end_time;
  if (run.half_cycles) {
    const HalfCycles& rows = *run.half_cycles;
    const HalfCycles::Damper& counted = rows.dampers[number];
    one.half_cycles = {
        rows.zero_crossing, rows.peak_time, divided(rows.amplitude, c), counted.impacts, {counted}};
  }
  if (run.impacts) {
    const Impacts& all = *run.impacts;
    Impacts& kept = one.impacts.emplace();
    for (std::size_t i = 0; i < all.time.size(); ++i) {
      if (all.damper[i] != its) continue;
      kept.time.push_back(all.time[i]);
      kept.wall.push_back(all.wall[i]);
      kept.relative_velocity.push_back(all.relative_velocity[i] / c);
      kept.phase_deg.push_back(all.phase_deg[i]);
      kept.amplitude.push_back(all.amplitude[i] ? std::optional(*all.amplitude[i] / c) : std::nullopt);
      kept.displacement.push_back(all.displacement[i] / c);
      kept.damper.push_back(0);
    }
  }
  if (run.contacts) {
    const Contacts& all = *run.contacts;
    Contacts& kept = one.contacts.emplace();
    for (std::size_t i = 0; i < all.begin.size(); ++i) {
      if (all.damper[i] != its) continue;
      kept.begin.push_back(all.begin[i]);
      kept.end.push_back(all.end[i]);
      kept.wall.push_back(all.wall[i]);
      kept.damper.push_back(0);
    }
  }
  if (run.history) {
    const History& all = *run.history;
    one.history = {all.time,
                   divided(all.x, c),
                   divided(all.v, c),
                   {{divided(all.dampers[number].y, c), divided(all.dampers[number].w, c)}}};
  }
  return one;
}

}  // namespace impact_damper
