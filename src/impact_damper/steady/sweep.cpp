#include "impact_damper/steady/sweep.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {

double Axis::value(std::int64_t i) const {
  return i == count - 1 ? to : from + (to - from) * (double(i) / double(count - 1));
}

std::vector<double> Axis::values() const {
  std::vector<double> all;
  for (std::int64_t i = 0; i < count; ++i) all.push_back(value(i));
  return all;
}

void require_valid(const Scene& scene, const Engine& engine, const Axis& axis) {
  const std::vector<NamedSceneNumber> all = numbers_of(scene);
  if (std::ranges::find(all, axis.number, &NamedSceneNumber::number) == all.end())
    throw InvalidArguments(
        {{name_of(axis.number), has_one_damper(scene) ? "is for several dampers: the scene has no list"
                                                      : "must be of one of the scene's several dampers"}});
  for (std::int64_t i = 0; i < axis.count; ++i) require_none(problems_of(axis.at(scene, i), engine));
}

std::vector<SweepStart> nudged(const std::vector<SceneState>& starts, double nudge) {
  std::vector<SweepStart> all;
  for (std::size_t n = 0; n < starts.size(); ++n) all.emplace_back(starts[n], double(n) * nudge);
  return all;
}

Scene Axis::at(Scene scene, std::int64_t i) const {
  number.in(scene) = value(i);
  return scene;
}

std::vector<SteadyState> steady_states_along(const Scene& scene, const Engine& engine,
                                             const SceneNumber& number, const std::vector<double>& values,
                                             const SteadyRule& rule, const SweepStart& start,
                                             const std::function<void()>& after_each) {
  require_none(problems_of(rule));
  std::vector<SteadyState> all;
  Scene there = scene;
  SceneState state = start;
  for (const double value : values) {
    double& now = number.in(there);
    if (!all.empty()) {
      state.x += start.nudge;
      if (number.of_damper == &SceneDamper::clearance) state.dampers[*number.damper].y *= value / now;
    }
    now = value;
    all.push_back(ForcedScene(there, engine).settle(state, rule));
    state = all.back().state;
    after_each();
  }
  return all;
}

std::vector<Sweep> sweep(const Scene& scene, const Engine& engine, const Axis& axis, const SteadyRule& rule,
                         const std::vector<SweepStart>& starts, const Threads& threads,
                         const std::function<void(std::int64_t done)>& progress) {
  require_none(problems_of(rule));
  // Throws for all that is not valid before anything is simulated.
  for (const SweepStart& start : starts) require_valid(released_from(scene, start), engine, axis);

  progress(0);
  const std::vector<double> upwards = axis.values(), downwards(upwards.rbegin(), upwards.rend());
  std::vector<Sweep> sweeps(starts.size());
  std::atomic<std::int64_t> done{0};
  for_each_index(std::int64_t(starts.size()), threads, [&](std::int64_t n) {
    Sweep& all = sweeps[static_cast<std::size_t>(n)];
    all.start = starts[static_cast<std::size_t>(n)];
    const auto along = [&](const std::vector<double>& values, const SceneState& from) {
      return steady_states_along(released_from(scene, all.start), engine, axis.number, values, rule,
                                 {from, all.start.nudge}, [&] { progress(++done); });
    };
    all.up = along(upwards, all.start);
    all.down = along(downwards, all.up.back().state);
    std::ranges::reverse(all.down);
  });
  return sweeps;
}

// --- Maps -------------------------------------------------------------------------------------------------

namespace {

// Points along each axis of the grid from which the motions of a scene are collected first.
constexpr std::int64_t coarse = 16;

// Whether no secondary mass ever has an impact again (M14.5).
class Idle {
 public:
  explicit Idle(const Scene& scene) : omega_(scene.force_frequency), dampers_(scene.dampers) {
    // The steady state of the primary mass alone, in_phase sin + behind cos.
    const double re = 1 - omega_ * omega_, im = 2 * scene.damping_ratio * omega_;
    const double h2 = re * re + im * im;
    in_phase_ = scene.force_amplitude * re / h2;
    behind_ = -scene.force_amplitude * im / h2;
    steady_ = std::abs(scene.force_amplitude) / square_root(h2);
  }
  bool holds(const SceneState& s) const {
    const double x = s.x - behind_, v = s.v - omega_ * in_phase_;
    const double reach = steady_ + square_root(x * x + v * v);  // (M3.4) for the transient
    // False where resonance makes the reach infinite, or a NaN.
    const auto is_out_of_reach = [&](double y, double w, double clearance) {
      const double z = s.x + y;
      return std::abs(s.v + w) <= at_rest && reach < z && z < clearance - reach;
    };
    for (std::size_t i = 0; i < dampers_.size(); ++i)
      if (!is_out_of_reach(s.dampers[i].y, s.dampers[i].w, dampers_[i].clearance)) return false;
    return true;
  }

 private:
  // Speed in space below which a mass counts as at rest: rounding errors of a velocity over some periods.
  static constexpr double at_rest = 64 * std::numeric_limits<double>::epsilon();
  double omega_;
  std::vector<SceneDamper> dampers_;
  double in_phase_, behind_, steady_;
};

// The attractor of a steady motion, with its states at phase 0 if they are wanted.
Attractor attractor_of(const ForcedScene& scene, const SteadyState& steady, bool with_states) {
  Attractor found{steady.impacts == ImpactCounts{} && steady.period == 1, *steady.period, steady.impacts,
                  steady.symmetric};
  if (!found.idle) found.impacts_by_damper = steady.impacts_by_damper;
  for (SceneState state = steady.state; with_states && std::ssize(found.states) < found.period;) {
    const ForcedScene::Watched passed = *scene.pass_periods(state);  // does not fail: it found the period
    for (const SceneState& each : passed.states)
      if (std::ssize(found.states) < found.period) found.states.push_back(each);
    state = passed.states.back();
  }
  return found;
}

bool all_are_struck(const Attractor& attractor) {
  return std::ranges::find(attractor.impacts_by_damper, ImpactCounts{}) == attractor.impacts_by_damper.end();
}

bool same_kind(const Attractor& a, const Attractor& b) {
  if (a.idle || b.idle) return a.idle == b.idle;
  if (a.period != b.period || a.impacts != b.impacts || a.impacts_by_damper != b.impacts_by_damper)
    return false;
  return a.symmetric == b.symmetric || !all_are_struck(a);  // a mass may rest in the middle by chance
}

// The state with y and w of dampers without impacts reset: where they rest does not distinguish motions.
SceneState of_struck(SceneState state, const Attractor& attractor) {
  for (std::size_t i = 0; i < attractor.impacts_by_damper.size(); ++i)
    if (attractor.impacts_by_damper[i] == ImpactCounts{}) state.dampers[i] = {};
  return state;
}

bool same(const Attractor& a, const Attractor& b, double near) {
  if (!same_kind(a, b)) return false;
  if (a.idle || a.states.empty()) return true;
  const SceneState first = of_struck(a.states.front(), a);
  return std::ranges::any_of(b.states, [&](const SceneState& state) {
    const SceneState other = of_struck(state, b);
    return distance(first, other) <= near * size_of(other);
  });
}

// Index of the attractor among `all`, to which it is added if it is new.
std::int32_t index_of(std::vector<Attractor>& all, const Attractor& found, double near) {
  const auto known =
      std::ranges::find_if(all, [&](const Attractor& each) { return same(each, found, near); });
  if (known != all.end()) return static_cast<std::int32_t>(known - all.begin());
  all.push_back(found);
  return static_cast<std::int32_t>(all.size()) - 1;
}

// Decides, from state to state at phase 0, which known motion captures a trajectory.
class Capture {
 public:
  Capture(const std::vector<Attractor>& known, double radius) : known_(known), radius_(radius) {}

  std::optional<std::int32_t> add(const SceneState& state) {
    ++now_;
    if (candidate_ >= 0 && now_ == due_) {
      const Attractor& attractor = known_[static_cast<std::size_t>(candidate_)];
      if (distance(state, attractor.states[phase_]) < distance_) return candidate_;
      candidate_ = -1;
    }
    for (std::size_t i = 0; candidate_ < 0 && i < known_.size(); ++i) {
      // A mass that seems to rest may still drift into a wall: such a motion is decided by SteadyRule only.
      if (known_[i].idle || !all_are_struck(known_[i])) continue;
      for (std::size_t phase = 0; phase < known_[i].states.size(); ++phase) {
        const double far = distance(state, known_[i].states[phase]);
        if (!(far <= radius_)) continue;
        candidate_ = static_cast<std::int32_t>(i);
        phase_ = phase;
        distance_ = far;
        due_ = now_ + known_[i].period;
        break;
      }
    }
    return std::nullopt;
  }

 private:
  const std::vector<Attractor>& known_;
  double radius_;
  std::int64_t now_ = 0, due_ = 0;
  std::int32_t candidate_ = -1;
  std::size_t phase_ = 0;
  double distance_ = 0;
};

// The motion that a point ends in: a known one, by its index; or another one; or neither.
struct Decision {
  std::optional<std::int32_t> known{};
  std::optional<Attractor> found{};
  bool stopped = false;  // by a budget
};

// Simulates from a state at phase 0 until one of the rules of basin() decides the point.
Decision decide(const ForcedScene& scene, const SceneState& start, const Idle& idle,
                const std::vector<Attractor>& known, const BasinRule& rule, bool with_states) {
  Decision decision;
  Capture capture(known, rule.capture_radius);
  SteadyState steady = scene.follow(start, rule.steady, [&](const SceneState& state) {
    if (idle.holds(state)) {
      decision.found = Attractor{.idle = true};
    } else {
      decision.known = capture.add(state);
    }
    return decision.found || decision.known;
  });
  if (steady.period) {
    scene.measure(steady, rule.steady);
    if (steady.means) decision.found = attractor_of(scene, steady, with_states);
  }
  decision.stopped = steady.stop_reason != StopReason::time;
  return decision;
}

// One row of the map: indices below the number of known motions are theirs, then come those found in the
// row.
struct Row {
  std::vector<std::int32_t> attractor;
  std::vector<Attractor> found;
  std::int64_t stopped = 0;
};

class Map {
 public:
  Map(const Scene& scene, const Engine& engine, const Axis& first, const Axis& second, const BasinRule& rule)
      : scene_(scene),
        engine_(engine),
        first_(first),
        second_(second),
        rule_(rule),
        one_system_(is_initial_value(first.number) && is_initial_value(second.number)),
        system_(second.at(first.at(scene, 0), 0), engine) {}

  bool one_system() const { return one_system_; }
  Decision decide_point(std::int64_t i, std::int64_t j, const std::vector<Attractor>& known) const {
    const Scene scene = at(i, j);
    if (one_system_) return decide(system_, release_of(scene), Idle(scene), known, rule_, true);
    return decide(ForcedScene(scene, engine_), release_of(scene), Idle(scene), known, rule_, false);
  }
  Row row(std::int64_t j, const std::vector<Attractor>& known) const {
    Row row;
    for (std::int64_t i = 0; i < first_.count; ++i) add(row, decide_point(i, j, known), known);
    return row;
  }
  // The motions that a coarse grid of points ends in, in the order of the points.
  std::vector<Attractor> survey(const Threads& threads) const {
    const std::int64_t columns = std::min(coarse, first_.count), rows = std::min(coarse, second_.count);
    std::vector<Decision> decisions(static_cast<std::size_t>(columns * rows));
    for_each_index(columns * rows, threads, [&](std::int64_t n) {
      decisions[static_cast<std::size_t>(n)] = decide_point(spread(n % columns, columns, first_.count),
                                                            spread(n / columns, rows, second_.count), {});
    });
    std::vector<Attractor> known;
    for (const Decision& each : decisions)
      if (each.found) index_of(known, *each.found, rule_.capture_radius);
    return known;
  }
  void require_valid() const {
    require_none(problems_of(first_.at(second_.at(scene_, 0), 0), engine_));
    impact_damper::require_valid(second_.at(scene_, 0), engine_, first_);
    impact_damper::require_valid(first_.at(scene_, 0), engine_, second_);
  }
  std::int32_t index(std::vector<Attractor>& all, const Attractor& found) const {
    return index_of(all, found, rule_.capture_radius);
  }

 private:
  static std::int64_t spread(std::int64_t i, std::int64_t points, std::int64_t count) {
    return points == 1 ? 0 : i * (count - 1) / (points - 1);
  }
  Scene at(std::int64_t i, std::int64_t j) const { return second_.at(first_.at(scene_, i), j); }
  void add(Row& row, const Decision& decision, const std::vector<Attractor>& known) const {
    row.stopped += decision.stopped;
    row.attractor.push_back(decision.known ? *decision.known
                            : decision.found
                                ? static_cast<std::int32_t>(known.size()) + index(row.found, *decision.found)
                                : undecided);
  }

  const Scene& scene_;
  const Engine& engine_;
  const Axis &first_, &second_;
  const BasinRule& rule_;
  bool one_system_;
  ForcedScene system_;
};

}  // namespace

bool is_initial_value(const SceneNumber& number) {
  return number.is(&Scene::x0) || number.is(&Scene::v0) || number.is(&SceneDamper::y0) ||
         number.is(&SceneDamper::w0);
}

std::vector<Problem> problems_of(const BasinRule& rule) {
  std::vector<Problem> problems = problems_of(rule.steady);
  if (!(rule.capture_radius > 0 && rule.capture_radius <= 0.5))
    problems.push_back({"capture_radius", "must be > 0 and <= 0.5, got " + number_text(rule.capture_radius)});
  return problems;
}

Basin basin(const Scene& scene, const Engine& engine, const Axis& first, const Axis& second,
            const BasinRule& rule, const Threads& threads,
            const std::function<void(std::int64_t done)>& progress) {
  require_none(problems_of(rule));
  const Map map(scene, engine, first, second, rule);
  map.require_valid();
  progress(0);
  Basin basin;
  if (map.one_system()) basin.attractors = map.survey(threads);
  const std::vector<Attractor> known = basin.attractors;
  std::vector<Row> rows(static_cast<std::size_t>(second.count));
  std::atomic<std::int64_t> done{0};
  for_each_index(second.count, threads, [&](std::int64_t j) {
    rows[static_cast<std::size_t>(j)] = map.row(j, known);
    progress(done += first.count);
  });

  // In the order of the rows, so that indices do not depend on which row was finished first.
  std::vector<Attractor>& all = basin.attractors;
  for (const Row& row : rows) {
    std::vector<std::int32_t> index_in_all(known.size());
    std::iota(index_in_all.begin(), index_in_all.end(), 0);
    for (const Attractor& found : row.found) index_in_all.push_back(map.index(all, found));
    for (const std::int32_t local : row.attractor) {
      const std::int32_t index =
          local == undecided ? undecided : index_in_all[static_cast<std::size_t>(local)];
      if (index != undecided) ++all[static_cast<std::size_t>(index)].points;
      basin.attractor.push_back(index);
    }
    basin.stopped += row.stopped;
  }

  std::vector<std::int32_t> order(all.size()), rank(all.size());
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater<>{},
                           [&](std::int32_t i) { return all[static_cast<std::size_t>(i)].points; });
  std::vector<Attractor> sorted;
  for (const std::int32_t index : order) {
    rank[static_cast<std::size_t>(index)] = static_cast<std::int32_t>(sorted.size());
    sorted.push_back(std::move(all[static_cast<std::size_t>(index)]));
  }
  all = std::move(sorted);
  for (std::int32_t& index : basin.attractor)
    if (index != undecided) index = rank[static_cast<std::size_t>(index)];
  return basin;
}

}  // namespace impact_damper
