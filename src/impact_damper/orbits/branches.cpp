#include "impact_damper/orbits/branches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {
namespace {

constexpr double points_along_range = 100;  // no step exceeds the range divided by it
// Distance beyond the end of a branch at which a simulation looks for another, in units of the range.
constexpr double beyond_end = 1e-3;

struct PeriodicMotion {
  SteadyState steady;
  std::optional<Expected<Orbit, NoOrbit>> orbit;  // absent: it is not periodic
};

class BranchSearch {
 public:
  BranchSearch(const Engine& engine, const ParameterRange& range, const BranchRule& rule)
      : engine_(engine), range_(range), rule_(rule) {}

  Scene at(Scene scene, double value) const {
    scene.*member_of(range_.parameter) = value;
    return scene;
  }
  double value_of(const Orbit& orbit) const { return orbit.scene.*member_of(range_.parameter); }

  // The steady state of a simulation from `state` and, if it is periodic, the orbit that Newton's method
  // finds.
  PeriodicMotion settled(const Scene& scene, const SceneState& state) const {
    const ForcedScene forced(scene, engine_);
    PeriodicMotion motion;
    motion.steady = forced.follow(state, rule_.steady, [](const SceneState&) { return false; });
    if (motion.steady.stop_reason != StopReason::time || !motion.steady.period) return motion;
    const int periods = int(*motion.steady.period);
    const SceneState& s = motion.steady.state;
    const auto watched = forced.watch(s, periods);
    if (!watched) {
      motion.steady.stop_reason = watched.failure();
      return motion;
    }
    SceneState centred = s;
    for (std::size_t i = 0; i < s.dampers.size(); ++i)
      if (watched->by_damper[i] == ImpactCounts{} && !has_components(scene))
        centred.dampers[i] = {scene.dampers[i].clearance / 2 - s.x, -s.v};
    if (watched->impacts == ImpactCounts{} && has_mirror(scene)) {
      motion.orbit = find_orbit(scene, engine_, 1, centred, {.symmetric = true});
    } else if (has_one_damper(scene)) {
      motion.orbit = find_orbit(scene, engine_, periods, s);
    } else {
      motion.orbit = find_orbit(scene, engine_, periods, centred);
      if (!*motion.orbit) motion.orbit = find_orbit(scene, engine_, periods, s);
    }
    return motion;
  }

  // The index of the known branch on which an orbit lies, if there is one.
  std::optional<std::int64_t> known(const std::vector<FollowedBranch>& branches, const Orbit& orbit) const {
    for (std::size_t i = 0; i < branches.size(); ++i)
      if (lies_on(branches[i].branch, orbit)) return std::int64_t(i);
    return std::nullopt;
  }
  // Whether a known branch ended by joining at this event, so that the one that begins here is known.
  bool is_joined(const std::vector<FollowedBranch>& branches, const BranchEvent& event) const {
    return std::ranges::any_of(branches, [&](const FollowedBranch& each) {
      const Branch& branch = each.branch;
      if (branch.end != BranchEnd::joined) return false;
      const BranchEvent& end = branch.events.back();
      // Both are known to 1e-10 in the parameter, and to the square root of that in the state.
      return end.kind == event.kind && std::abs(end.parameter - event.parameter) <= 1e-8 * event.parameter &&
             is_twin(event.orbit, release_of(end.orbit.scene), 1e-3);
    });
  }

  Branch follow_from(const Orbit& orbit, bool upwards) const {
    FollowOptions options;
    options.least = range_.least();
    options.most = range_.most();
    options.upwards = upwards;
    options.largest_step = rule_.largest_step;
    options.first_step = std::min(options.first_step, options.largest_step);
    options.largest_change = (options.most - options.least) / points_along_range;
    options.max_multiplier = rule_.max_multiplier;
    options.max_points = int(rule_.max_points);
    return follow(orbit, range_.parameter, options);
  }

  // The orbit that a simulation ends in a little beyond the end of a branch, where that is a grazing, a
  // coincidence or a step that became too small. Nothing if there is none, or that is not in the range.
  // `upwards`: whether the parameter rose there.
  std::optional<Orbit> beyond(const Branch& branch, bool& upwards) const {
    if (branch.end != BranchEnd::grazing && branch.end != BranchEnd::coincidence &&
        branch.end != BranchEnd::step_too_small)
      return {};
    if (branch.orbits.size() < 2) return {};
    const Orbit& last = branch.orbits.back();
    const double end = branch.end == BranchEnd::grazing ? branch.events.back().parameter : value_of(last);
    upwards = value_of(last) > value_of(branch.orbits[branch.orbits.size() - 2]);
    const double value = end + (upwards ? 1 : -1) * beyond_end * (range_.most() - range_.least());
    if (!(value > range_.least() && value < range_.most())) return {};
    PeriodicMotion motion = settled(at(last.scene, value), release_of(last.scene));
    if (!motion.orbit || !*motion.orbit) return {};
    return **std::move(motion.orbit);
  }

  // The orbit at which a branch ends by joining another, as an orbit of that other branch.
  std::optional<Orbit> joined(const Branch& branch) const {
    if (branch.end != BranchEnd::joined) return {};
    const BranchEvent& end = branch.events.back();
    const Scene& scene = end.orbit.scene;
    const bool symmetric = end.kind == BranchEventKind::symmetry_breaking;
    const int periods = symmetric ? end.orbit.periods : end.orbit.periods / 2;
    auto orbit = find_orbit(scene, engine_, periods, release_of(scene), {.symmetric = symmetric});
    return orbit ? std::optional(*std::move(orbit)) : std::nullopt;
  }

  double amplitude_of(const Orbit& orbit) const {
    // Over two periods: a half cycle that is not complete in the first is in the second.
    const auto watched =
        ForcedScene(orbit.scene, engine_).watch(release_of(orbit.scene), std::int64_t{2} * orbit.periods);
    if (!watched)
      throw NumericalError("the largest |x| of an orbit was not found: " +
                           std::string(name_of(watched.failure())));
    return watched->amplitude;
  }

 private:
  // Whether a state is one of the orbit at phase 0, or of its mirror image, to within `gap` of its size.
  bool is_twin(const Orbit& orbit, const SceneState& state, double gap) const {
    const int half_periods = has_mirror(orbit.scene) ? 1 : 2;
    const PoincareMap map(orbit.scene, engine_, half_periods);
    SceneState s = release_of(orbit.scene);
    for (int n = 0; n < 2 * orbit.periods; n += half_periods) {
      if (distance(s, state) <= gap * size_of(state)) return true;
      const auto image = map(s, PoincareMap::Derivatives::none);
      if (!image) return false;
      s = image->state;
    }
    return false;
  }
  // Whether Newton's method leads from a branch, at its point nearest in the parameter, to the orbit.
  bool lies_on(const Branch& branch, const Orbit& orbit) const {
    const double value = value_of(orbit);
    for (std::size_t i = 0; i < branch.orbits.size(); ++i) {
      const Orbit &a = branch.orbits[i], &b = branch.orbits[std::min(i + 1, branch.orbits.size() - 1)];
      const double low = std::min(value_of(a), value_of(b)), high = std::max(value_of(a), value_of(b));
      if (a.periods != orbit.periods || a.symmetric != orbit.symmetric || value < low || value > high)
        continue;
      const Orbit& nearer = std::abs(value_of(a) - value) <= std::abs(value_of(b) - value) ? a : b;
      const auto there = find_orbit(orbit.scene, engine_, orbit.periods, release_of(nearer.scene),
                                    {.symmetric = orbit.symmetric});
      if (there && is_twin(orbit, release_of(there->scene), 1e-6)) return true;
    }
    return false;
  }

  Engine engine_;
  ParameterRange range_;
  BranchRule rule_;
};

}  // namespace

std::vector<Problem> problems_of(const BranchRule& rule) {
  std::vector<Problem> problems = problems_of(rule.steady);
  const auto check = [&](const char* name, double value, const NumberRange& range) {
    if (!range.allows(value))
      problems.push_back({name, range.describe("must be") + ", got " + number_text(value)});
  };
  check("largest_step", rule.largest_step, within(1e-6, 1e6));
  check("max_multiplier", rule.max_multiplier, within(1, 1e12));
  check("max_points", double(rule.max_points), most_branch_points);
  check("max_branches", double(rule.max_branches), most_branches);
  return problems;
}

std::string_view end_of(const BranchStart& start) {
  if (start.steady.stop_reason != StopReason::time) return name_of(start.steady.stop_reason);
  if (!start.orbit) return "not_periodic";
  return *start.orbit == OrbitEnd::converged ? "periodic" : name_of(*start.orbit);
}

Branches find_branches(const Scene& scene, const Engine& engine, const ParameterRange& range,
                       const BranchRule& rule, const std::vector<SceneState>& starts, const Threads& threads,
                       const std::function<void(std::int64_t done)>& progress) {
  std::vector<Problem> problems = problems_of(rule);
  if (!(range.from > 0 && range.to > 0 && range.from != range.to))
    problems.push_back({"range", "must be two different numbers > 0"});
  if (scene.dampers.size() > most_dampers_with_changes)
    problems.push_back({"dampers", "must be at most " + std::to_string(most_dampers_with_changes) +
                                       " for orbits, got " + std::to_string(scene.dampers.size())});
  for (const SceneState& start : starts)
    if (start.dampers.size() != scene.dampers.size())
      problems.push_back({"starts", "must be of as many dampers as the scene's list, " +
                                        std::to_string(scene.dampers.size()) + ", got " +
                                        std::to_string(start.dampers.size())});
  require_none(problems);
  const BranchSearch search(engine, range, rule);
  for (const double value : {range.from, range.to})
    for (const SceneState& start : starts)
      require_none(problems_of(search.at(released_from(scene, start), value), engine));

  Branches all;
  progress(0);
  std::vector<PeriodicMotion> motions(starts.size());
  for_each_index(std::int64_t(starts.size()), threads, [&](std::int64_t n) {
    const SceneState& start = starts[static_cast<std::size_t>(n)];
    motions[static_cast<std::size_t>(n)] = search.settled(search.at(scene, range.from), start);
  });

  const auto add = [&](BranchOrigin origin, std::int64_t from, std::optional<std::int64_t> event,
                       const Orbit& orbit, bool upwards) {
    if (std::ssize(all.branches) == rule.max_branches) {
      all.complete = false;
      return false;
    }
    all.branches.push_back({origin, from, event, search.follow_from(orbit, upwards), {}, {}});
    progress(std::ssize(all.branches));
    return true;
  };
  for (std::size_t n = 0; n < starts.size(); ++n) {
    BranchStart start{starts[n], motions[n].steady, std::nullopt, std::nullopt};
    if (motions[n].orbit) {
      const Expected<Orbit, NoOrbit>& orbit = *motions[n].orbit;
      start.orbit = orbit ? OrbitEnd::converged : orbit.failure().end;
      if (orbit) {
        start.branch = search.known(all.branches, *orbit);
        if (!start.branch &&
            add(BranchOrigin::start, std::int64_t(n), std::nullopt, *orbit, range.to > range.from))
          start.branch = std::ssize(all.branches) - 1;
      }
    }
    all.starts.push_back(start);
  }

  // The branches that begin at the events and at the end of each branch, including those found on the way.
  for (std::int64_t n = 0; n < std::ssize(all.branches); ++n) {
    const Branch branch = all.branches[static_cast<std::size_t>(n)].branch;
    const auto add_both_ways = [&](BranchOrigin origin, std::optional<std::int64_t> event,
                                   const std::optional<Orbit>& orbit, bool upwards) {
      if (!orbit || search.known(all.branches, *orbit)) return;
      add(origin, n, event, *orbit, upwards);
      add(origin, n, event, *orbit, !upwards);
    };
    for (std::size_t i = 0; i < branch.events.size(); ++i) {
      const BranchEvent& event = branch.events[i];
      if (branch.end == BranchEnd::joined && i + 1 == branch.events.size()) {
        add_both_ways(BranchOrigin::event, std::int64_t(i), search.joined(branch), true);
        continue;
      }
      if (search.is_joined(all.branches, event)) continue;
      const auto orbit = branching_off(event, range.parameter);
      if (!orbit || orbit->periods > rule.steady.longest_period) continue;
      const double value = search.value_of(*orbit);
      if (!(value >= range.least() && value <= range.most())) continue;
      add(BranchOrigin::event, n, std::int64_t(i), *orbit, value > event.parameter);
    }
    bool upwards = true;
    const std::optional<Orbit> beyond = search.beyond(branch, upwards);
    add_both_ways(BranchOrigin::beyond, std::nullopt, beyond, upwards);
  }

  for (FollowedBranch& each : all.branches) {
    each.amplitudes.resize(each.branch.orbits.size());
    each.event_amplitudes.resize(each.branch.events.size());
    const auto orbits = std::ssize(each.branch.orbits);
    for_each_index(orbits + std::ssize(each.branch.events), threads, [&](std::int64_t i) {
      const auto index = static_cast<std::size_t>(i < orbits ? i : i - orbits);
      (i < orbits ? each.amplitudes : each.event_amplitudes)[index] =
          search.amplitude_of(i < orbits ? each.branch.orbits[index] : each.branch.events[index].orbit);
    });
  }
  return all;
}

}  // namespace impact_damper
