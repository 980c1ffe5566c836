#include "impact_damper/responses/responses.hpp"

#include <utility>

namespace impact_damper {
namespace {

OrbitPoint point_of(const Orbit& orbit, double value, double amplitude) {
  OrbitPoint point{.value = value,
                   .period = orbit.periods,
                   .symmetric = orbit.symmetric,
                   .stable = orbit.stable(),
                   .impacts = {},
                   .sticking = orbit.sticking,
                   .amplitude = amplitude,
                   .multipliers = orbit.multipliers,
                   .slowest_impact = orbit.slowest_impact,
                   .nearest_miss = orbit.nearest_miss,
                   .least_interval = orbit.least_interval,
                   .stop_margin = orbit.stop_margin,
                   .state = release_of(orbit.scene),
                   .impacts_by_damper = std::vector<ImpactCounts>(orbit.scene.dampers.size())};
  point.multipliers.resize(4);
  for (const OrbitImpact& impact : orbit.impacts) {
    const auto side = std::size_t(impact.wall);
    ++point.impacts[side];
    ++point.impacts_by_damper[std::size_t(impact.damper)][side];
  }
  return point;
}

}  // namespace

OrbitsResponse orbits_response(const Scene& scene, const Engine& engine, const BranchRule& rule,
                               const ParameterRange& range, const Branches& branches) {
  OrbitsResponse response{.scene = scene,
                          .engine = engine,
                          .rule = rule,
                          .range = range,
                          .starts = {},
                          .complete = branches.complete,
                          .branches = {}};
  for (const BranchStart& start : branches.starts)
    response.starts.push_back(
        {std::string(end_of(start)), start.steady.transient_periods, start.branch, start.state});
  for (const FollowedBranch& each : branches.branches) {
    OrbitBranch branch{.origin = each.origin,
                       .from = each.from,
                       .event = each.event,
                       .end = each.branch.end,
                       .points = {},
                       .events = {}};
    for (std::size_t i = 0; i < each.branch.orbits.size(); ++i) {
      const Orbit& orbit = each.branch.orbits[i];
      branch.points.push_back(point_of(orbit, orbit.scene.*member_of(range.parameter), each.amplitudes[i]));
    }
    for (std::size_t i = 0; i < each.branch.events.size(); ++i) {
      const BranchEvent& event = each.branch.events[i];
      branch.events.push_back({point_of(event.orbit, event.parameter, each.event_amplitudes[i]), event.kind,
                               event.orbits_before});
    }
    response.branches.push_back(std::move(branch));
  }
  return response;
}

std::string_view kind_of(const Response& response) {
  return std::visit([](const auto& each) { return each.kind; }, response);
}

Response found_for(Response asked, const Threads& threads) {
  const auto ignored = [](std::int64_t) {};
  if (auto* const sweeps = std::get_if<SweepResponse>(&asked)) {
    std::vector<SweepStart> starts;
    for (const Sweep& each : sweeps->sweeps) starts.push_back(each.start);
    sweeps->sweeps =
        sweep(sweeps->scene, sweeps->engine, sweeps->axis, sweeps->rule, starts, threads, ignored);
  } else if (auto* const map = std::get_if<BasinResponse>(&asked)) {
    map->basin = basin(map->scene, map->engine, map->first, map->second, map->rule, threads, ignored);
  } else if (auto* const orbits = std::get_if<OrbitsResponse>(&asked)) {
    std::vector<SceneState> starts;
    for (const OrbitStart& each : orbits->starts) starts.push_back(each.state);
    return orbits_response(
        orbits->scene, orbits->engine, orbits->rule, orbits->range,
        find_branches(orbits->scene, orbits->engine, orbits->range, orbits->rule, starts, threads, ignored));
  } else if (auto* const lyapunov = std::get_if<LyapunovResponse>(&asked)) {
    lyapunov->found =
        lyapunov_exponents(lyapunov->scene, lyapunov->engine, lyapunov->periods, lyapunov->discard);
  }
  return asked;
}

std::string_view end_of(const SteadyState& steady) {
  if (steady.stop_reason != StopReason::time) return name_of(steady.stop_reason);
  return steady.period ? "periodic" : "not_periodic";
}

}  // namespace impact_damper
