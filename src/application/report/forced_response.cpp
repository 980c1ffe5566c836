#include "application/report/forced_response.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "impact_damper/math/elementary.hpp"
#include "impact_damper/steady/sweep.hpp"

namespace impact_damper {
namespace {

using Way = ArrivedMotion ResponsePoint::*;
constexpr std::array<Way, 2> both_ways{&ResponsePoint::rising, &ResponsePoint::falling};

// Budgets of a run, which lasts eight periods of the force or a tenth of `mean_periods`. A motion that needs
// more is given up.
constexpr std::int64_t most_impacts_of_a_run = 20'000, most_steps_of_a_run = 1'000'000;

Engine bounded(const Engine& engine) {
  return std::visit(
      [](auto each) -> Engine {
        each.budget.max_impacts = std::min(each.budget.max_impacts, most_impacts_of_a_run);
        each.max_steps = std::min(each.max_steps, most_steps_of_a_run);
        return each;
      },
      engine);
}

Scene at_frequency(Scene scene, double frequency) {
  scene.force_frequency = frequency;
  return scene;
}

double locked_resonance(const Scene& scene) { return 1 / square_root(1 + secondary_mass(scene)); }

// Returns the impacts in a period of the force from the release on, at the resonance with more of them;
// infinity if a budget ends the run.
double impacts_in_a_period(const Scene& scene, const Engine& engine) {
  constexpr std::int64_t periods = 100;
  double most = 0;
  for (const double resonance : {locked_resonance(scene), 1.0}) {
    const auto watched =
        ForcedScene(at_frequency(scene, resonance), engine).watch(release_of(scene), periods);
    if (!watched) return std::numeric_limits<double>::infinity();
    most = std::max(most, double(watched->impacts[0] + watched->impacts[1]) / double(periods));
  }
  return most;
}

// Returns a rule with fewer periods of the force for motions with many impacts, and without viscous damping,
// where a transient that impacts do not end soon never ends.
SteadyRule rule_for(const Scene& scene, const Engine& engine) {
  constexpr double impacts_of_a_motion = 20'000;
  constexpr std::int64_t least = 500, hundred = 100;
  SteadyRule rule;
  rule.tolerance = 1e-7;
  if (scene.damping_ratio == 0) rule.max_periods = least;
  if (const double impacts = impacts_in_a_period(scene, engine); impacts > 0) {
    const double periods = std::min(double(rule.max_periods), impacts_of_a_motion / impacts);
    rule.max_periods = std::max(least, static_cast<std::int64_t>(periods) / hundred * hundred);
  }
  return rule;
}

// Returns the frequencies of the response besides the scene's own, ascending.
std::vector<double> other_frequencies(const Scene& scene, const Engine& engine) {
  constexpr double distinct = 5e-4;  // relative; closer frequencies count as one
  const double locked = locked_resonance(scene), given = scene.force_frequency;
  std::vector<double> all{0.97 * given, 1.03 * given};
  for (const double resonance : {locked, 1.0})
    for (const double away : {0.0, 0.002, 0.004, 0.007, 0.012, 0.02, 0.03, 0.045, 0.06, 0.08, 0.11, 0.15})
      for (const double sign : {-1.0, 1.0}) all.push_back(resonance * (1 + sign * away));
  for (int i = 1; i <= 5; ++i) all.push_back(locked + (1 - locked) * i / 6);
  std::ranges::sort(all);
  std::vector<double> kept;
  for (const double each : all) {
    const bool near_given = std::abs(each / given - 1) < distinct;
    const bool near_last = !kept.empty() && each < kept.back() * (1 + distinct);
    if (problems_of(at_frequency(scene, each), engine).empty() && !near_given && !near_last)
      kept.push_back(each);
  }
  return kept;
}

// Makes and refines a response.
class Sweeper {
 public:
  Sweeper(Scene scene, const Engine& engine, const SteadyRule& rule, const Threads& threads,
          const std::function<void(std::int64_t done)>& progress)
      : scene_(std::move(scene)), engine_(bounded(engine)), threads_(threads), progress_(progress) {
    response_.rule = rule;
  }

  ForcedResponse response() && { return std::move(response_); }

  // Sweeps up from the scene's release through its own frequency and these, which ascend, and back down.
  void sweep_through(std::vector<double> frequencies) {
    const auto own = std::ranges::lower_bound(frequencies, scene_.force_frequency);
    response_.given = static_cast<std::size_t>(own - frequencies.begin());
    frequencies.insert(own, scene_.force_frequency);
    const std::vector<double> downwards(frequencies.rbegin(), frequencies.rend());
    const std::vector<SteadyState> rising = along(frequencies, release_of(scene_));
    const std::vector<SteadyState> falling = along(downwards, rising.back().state);
    for (std::size_t i = 0; i < frequencies.size(); ++i)
      response_.points.push_back({frequencies[i], {rising[i], {}}, {falling[falling.size() - 1 - i], {}}});
  }

  // Adds three frequencies on either side of the largest amplitude, each way from the point before.
  void refine() {
    const auto largest = response_.largest();
    if (!largest) return;
    std::vector<ResponsePoint>& points = response_.points;
    const std::size_t at = largest->point, given = response_.given;
    struct Gap {
      std::size_t before;
      std::vector<double> frequencies;
      std::array<std::vector<SteadyState>, 2> ways;
    };
    std::vector<Gap> gaps;
    for (const std::size_t before : {at - 1, at}) {
      if (before >= points.size() - 1) continue;  // at - 1 of the first point, too
      const double from = points[before].frequency, to = points[before + 1].frequency;
      gaps.push_back({before, {}, {}});
      for (int k = 1; k <= 3; ++k) gaps.back().frequencies.push_back(from + (to - from) * k / 4);
    }
    for_each_index(2 * std::ssize(gaps), threads_, [&](std::int64_t i) {
      Gap& gap = gaps[static_cast<std::size_t>(i / 2)];
      const bool rises = i % 2 == 0;
      std::vector<double> frequencies = gap.frequencies;
      if (!rises) std::ranges::reverse(frequencies);
      std::vector<SteadyState>& way = gap.ways[static_cast<std::size_t>(i % 2)];
      way = along(frequencies, rises ? points[gap.before].rising.steady.state
                                     : points[gap.before + 1].falling.steady.state);
      if (!rises) std::ranges::reverse(way);
    });
    for (const Gap& gap : gaps) {
      if (gap.before < given) response_.given += gap.frequencies.size();
      for (std::size_t k = 0; k < gap.frequencies.size(); ++k)
        points.push_back({gap.frequencies[k], {gap.ways[0][k], {}}, {gap.ways[1][k], {}}});
    }
    std::ranges::sort(points, {}, &ResponsePoint::frequency);
  }

  // Follows motions again that are not periodic and on which much depends: where the two ways differ, and at
  // the largest amplitude, which may then be another. They may only have had a long transient.
  void confirm() {
    constexpr int rounds = 4;
    for (int round = 0; round < rounds; ++round) {
      std::vector<ArrivedMotion*> open;
      std::vector<double> frequencies;
      const auto largest = response_.largest();
      for (std::size_t i = 0; i < response_.points.size(); ++i) {
        ResponsePoint& point = response_.points[i];
        if (!point.has_two_motions() && !(largest && largest->point == i)) continue;
        for (const Way way : both_ways) {
          ArrivedMotion& motion = point.*way;
          if (!motion.is_known() || motion.is_periodic() || motion.earlier_amplitude) continue;
          open.push_back(&motion);
          frequencies.push_back(point.frequency);
        }
      }
      if (open.empty()) return;
      for_each_index(std::ssize(open), threads_, [&](std::int64_t i) {
        const auto n = static_cast<std::size_t>(i);
        ArrivedMotion& motion = *open[n];
        const SteadyState later = along({frequencies[n]}, motion.steady.state).front();
        if (!later.period) motion.earlier_amplitude = motion.amplitude();
        motion.steady = later;
      });
    }
  }

 private:
  std::vector<SteadyState> along(const std::vector<double>& frequencies, const SceneState& state) {
    return steady_states_along(scene_, engine_, &Scene::force_frequency, frequencies, response_.rule, state,
                               [&] { progress_(++done_); });
  }

  Scene scene_;
  Engine engine_;
  Threads threads_;
  const std::function<void(std::int64_t done)>& progress_;
  ForcedResponse response_;
  std::atomic<std::int64_t> done_{0};
};

}  // namespace

bool ArrivedMotion::changes() const {
  if (!is_known() || is_periodic()) return false;
  if (is_balanced(steady) == false) return true;
  const double scatter = steady.amplitude_scatter;
  return earlier_amplitude && amplitudes_differ(*earlier_amplitude, scatter, amplitude(), scatter);
}

bool ResponsePoint::has_two_motions() const {
  return rising.is_known() && falling.is_known() && !rising.changes() && !falling.changes() &&
         amplitudes_differ(rising.amplitude(), rising.steady.amplitude_scatter, falling.amplitude(),
                           falling.steady.amplitude_scatter);
}

std::optional<LargestAmplitude> ForcedResponse::largest(Way way) const {
  std::optional<LargestAmplitude> found;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const ArrivedMotion& motion = points[i].*way;
    if (motion.is_known() && !(found && motion.amplitude() <= found->motion.amplitude()))
      found = {i, points[i].frequency, motion};
  }
  return found;
}

std::optional<LargestAmplitude> ForcedResponse::largest() const {
  const auto rising = largest(&ResponsePoint::rising), falling = largest(&ResponsePoint::falling);
  if (!rising || !falling) return rising ? rising : falling;
  return falling->motion.amplitude() > rising->motion.amplitude() ? falling : rising;
}

std::vector<PointRange> ForcedResponse::two_motions() const {
  std::vector<PointRange> ranges;
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (!points[i].has_two_motions()) continue;
    if (!ranges.empty() && ranges.back().last + 1 == i) {
      ranges.back().last = i;
    } else {
      ranges.push_back({i, i});
    }
  }
  return ranges;
}

ForcedResponse forced_response(const Scene& scene, const Engine& engine, const Threads& threads,
                               const std::function<void(std::int64_t done)>& progress) {
  Sweeper sweeper(scene, engine, rule_for(scene, bounded(engine)), threads, progress);
  sweeper.sweep_through(other_frequencies(scene, engine));
  for (int round = 0; round < 2; ++round) sweeper.refine();
  sweeper.confirm();
  return std::move(sweeper).response();
}

}  // namespace impact_damper
