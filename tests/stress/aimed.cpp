// Scenes aimed at what is hard: where a last bit decides, where time is long or nothing happens in it.
#include <cmath>
#include <limits>
#include <numbers>

#include "counted.hpp"
#include "impact_damper/simulate.hpp"
#include "reference.hpp"
#include "stress.hpp"

namespace stress {

using namespace impact_damper;

namespace {

constexpr double epsilon = std::numeric_limits<double>::epsilon();

Check about(const std::string& what, const std::string& allowed) {
  return {.subject = "aimed", .what = what, .measured = {}, .allowed = allowed};
}

// Where e = 1 keeps bounces of any height for ever; and as much time as the longest scene here.
constexpr Budget few_impacts{.max_impacts = 300, .max_time = 1e9};
const std::array<Engine, 2> both{Exact{.budget = few_impacts}, Restitution{.budget = few_impacts}};

// Released at the peak x0 = A from the middle of the cavity with w0 < 0, the mass dips towards the left wall:
// y = 1/2 + w0 t + A (1 - cos t), least where A sin t = -w0.
Check grazing(const Options& options) {
  Check check = about("a dip to a wall, to the last bit: met or missed as the closed form says, to rounding",
                      "64 roundings");
  const std::int64_t seeds = options.seed ? 1 : options.brief ? 20 : 400;
  const std::uint64_t first = options.seed.value_or(1);
  Worst wrong_side;
  Progress progress("grazing");
  for (std::int64_t i = 0; i < seeds; ++i) {
    const std::uint64_t seed = first + std::uint64_t(i);
    reference::Random random(seed);
    Scene scene{.until_time = 1.2, .dampers = {{.y0 = 0.5}}};
    scene.x0 = random.uniform(1.5, 50);
    scene.damper().restitution = random.uniform(0, 1);
    for (const Engine& engine : both) {
      const auto met = [&](double w0) {
        scene.damper().w0 = w0;
        const Impacts impacts = *simulate(scene, engine, {.half_cycles = false, .impacts = true}).impacts;
        return !impacts.wall.empty() && impacts.wall[0] == Wall::left;
      };
      const double edge = last_bit(0, -2 * scene.x0, met);
      for (int ulps = -16; ulps <= 16; ++ulps) {
        scene.damper().w0 = steps_from(edge, ulps);
        const std::string which = "--seed " + std::to_string(seed);
        keep_promises(check, which, scene, engine);
        const long double a = scene.x0, t = std::asin(-(long double)scene.damper().w0 / a);
        const long double dip = 0.5L + scene.damper().w0 * t + a * (1 - std::cos(t));
        const double by_rounding = double(std::abs(dip)) / (epsilon * (1 + scene.x0));
        if (met(steps_from(edge, ulps)) == (dip < 0)) continue;
        wrong_side.take(by_rounding);
        if (!(by_rounding <= 64))
          check.miss(which + " " + rounded(by_rounding) + " roundings on the wrong side; " +
                     in_full(scene, engine));
      }
    }
    progress.tell(i, seeds);
  }
  check.measured = rounded(wrong_side) + " roundings";
  return check;
}

Check on_a_wall() {
  Check check =
      about("release exactly on a wall: an impact at once if and only if it moves into the wall", "all");
  const double least = least_magnitude;
  for (const double y0 : {0.0, 1.0}) {
    for (const double w0 : {0.0, -0.0, least, -least, epsilon, -epsilon, 1.0, -1.0, 1e8, -1e8}) {
      for (const double x0 : {0.0, least, -least, 6.0, -6.0}) {
        for (const double v0 : {0.0, 2.0, -2.0}) {
          for (const double e : {0.0, 0.6, 1.0}) {
            for (const double f0 : {0.0, 0.3}) {
              // Followed for seconds: see crawling().
              if (e == 1 && (std::abs(x0) == least || std::abs(w0) == least)) continue;
              // Deeper than y = 1 can be told from.
              if (y0 == 1 && std::abs(w0) == epsilon) continue;
              for (const Engine& engine : both) {
                // A lossless wall rings for ever, which is long to follow.
                const Scene scene{.x0 = x0,
                                  .v0 = v0,
                                  .force_amplitude = f0,
                                  .until_time = std::abs(w0) > 1 ? 1e-6
                                                : e == 1         ? 0.03
                                                                 : 2,
                                  .dampers = {{.restitution = e, .y0 = y0, .w0 = w0}}};
                if (!keep_promises(check, "case", scene, engine).all_kept()) continue;
                const Impacts impacts =
                    *simulate(scene, engine, {.half_cycles = false, .impacts = true}).impacts;
                const bool at_once = !impacts.time.empty() && impacts.time[0] == 0;
                if (at_once != (y0 == 0 ? w0 < 0 : w0 > 0))
                  check.miss((at_once ? "an impact at once; " : "no impact at once; ") +
                             in_full(scene, engine));
              }
            }
          }
        }
      }
    }
  }
  check.measured = check.all_or_not();
  return check;
}

// Bounce-down in every half cycle, late enough for its last impacts to fall into one last bit of time: with
// rigid walls by a tolerance that follows them to 1e-12, with compliant ones by contacts of 1e-11.
Check within_a_rounding(const Options& options) {
  Check check = about("bounce-down with several impacts in one last bit of time", "all");
  std::int64_t coincident = 0;
  for (const double e : {0.3, 0.5}) {
    for (const bool rigid : {true, false}) {
      const Scene scene{.until_time = options.brief ? 3e3 : 1e5,
                        .dampers = {{.mass_ratio = 1e-8, .restitution = e, .wall_stiffness = 1e15}}};
      const Budget enough{.max_impacts = 5'000'000};
      Engine engine = Exact{.budget = enough};
      if (rigid) engine = Restitution{.accumulation_tolerance = 1e-13, .budget = enough};
      ++check.cases;
      const Run run = simulate(scene, engine, {.impacts = true, .energy = true});
      const std::vector<double>& time = run.impacts->time;
      for (std::size_t i = 1; i < time.size(); ++i) {
        if (!(time[i] >= time[i - 1])) check.miss("impacts out of order; " + in_full(scene, engine));
        coincident += time[i] - time[i - 1] <= epsilon * time[i];
      }
      if (run.stop_reason != StopReason::time) check.miss("did not reach its end; " + in_full(scene, engine));
      if (!(std::abs(run.energy->residual) <= closed_balance))
        check.miss("energy balance open by " + rounded(run.energy->residual) + "; " + in_full(scene, engine));
      // Nothing decays at such a mass ratio: every half cycle is the third again, but for impacts that
      // rounding adds or takes at the end of a bounce-down.
      const std::vector<std::int64_t>& each = run.half_cycles->impacts;
      const auto [fewest, most] = std::minmax_element(each.begin() + 2, each.end());
      if (*most - *fewest > 4)
        check.miss("from " + std::to_string(*fewest) + " to " + std::to_string(*most) +
                   " impacts in a half cycle; " + in_full(scene, engine));
    }
  }
  check.measured = std::to_string(coincident) + " coincident";
  if (coincident == 0) check.miss("the aim was missed: no impacts coincide");
  return check;
}

// Released at the peak, the mass bounces on the right wall, and its bouncing comes to rest just before, or
// just not before, x = 0 lets it go.
Check accumulation_at_a_crossing() {
  Check check = about("a bounce-down that ends as x crosses zero, to the last bit", "all");
  for (const double e : {0.2, 0.4, 0.6, 0.8}) {
    for (const double nu : {1e-8, 0.02, 1.0}) {
      Scene scene{.until_time = 3, .dampers = {{.mass_ratio = nu, .restitution = e}}};
      const double edge = last_bit(0.6, 1000, [&](double x0) {
        scene.x0 = x0;
        const Run run = simulate(scene, Restitution{}, {.contacts = true});
        return !run.contacts->begin.empty() && run.contacts->begin[0] < run.half_cycles->zero_crossing[0];
      });
      for (int ulps = -16; ulps <= 16; ++ulps) {
        scene.x0 = steps_from(edge, ulps);
        for (const double k : {1e4, 1e8, 1e12}) {
          scene.damper().wall_stiffness = k;
          for (const Engine& engine : both) keep_promises(check, "case", scene, engine);
        }
      }
    }
  }
  check.measured = check.all_or_not();
  return check;
}

Check lossless(const Options& options, const Engine& engine) {
  const std::int64_t impacts = options.brief ? 100'000 : 10'000'000;
  Check check = about(std::string(name_of(engine)) + ", e = 1: drift of the energy over " +
                          (options.brief ? "1e5" : "1e7") + " impacts",
                      rounded(closed_balance));
  Engine budgeted = engine;
  std::visit([&](auto& options_of_it) { options_of_it.budget.max_impacts = impacts; }, budgeted);
  Worst worst;
  for (const double x0 : {6.0, 0.4}) {
    const Scene scene{.x0 = x0, .until_time = 1e12, .dampers = {{.restitution = 1, .w0 = 0.3}}};
    ++check.cases;
    say(check.what);
    const Run run = simulate(scene, budgeted, {.half_cycles = false, .energy = true});
    const EnergyBalance& balance = *run.energy;
    const double drift = std::abs(balance.final.total() / balance.initial.total() - 1);
    worst.take(drift);
    if (run.stop_reason != StopReason::impact_budget || !(drift <= closed_balance))
      check.miss("drift " + rounded(drift) + " to t = " + rounded(run.end_time) + ", stopped by " +
                 std::string(name_of(run.stop_reason)) + "; " + in_full(scene, engine));
  }
  check.measured = rounded(worst);
  return check;
}

// Flights that meet no wall, against their closed form in extended precision: the phase at time t is known to
// epsilon t where a frequency is rounded, and to epsilon where it is 1.
std::vector<Check> no_wall(const Options& options) {
  Check none = about("flights that meet no wall: no impact is found", "0 impacts");
  Check phase = about(
      "the same: x at the end, by epsilon (1 + t) where a frequency was rounded, epsilon where not", "16");
  Worst worst;
  std::int64_t found = 0;
  const double forced_end = options.brief ? 1e4 : 1e6;
  struct Flight {
    double x0, zeta, w0, f0, omega, end;
  };
  for (const Flight& f :
       {Flight{0.2, 0, 0, 0, 1, 1e9}, Flight{0.49, 0, 0, 0, 1, 1e9}, Flight{0.2, 0, 1e-10, 0, 1, 1e9},
        Flight{0.3, 1e-9, 0, 0, 1, 1e9}, Flight{0.3, 0.5, 0, 0, 1, 1e9}, Flight{0.45, 5, 0, 0, 1, 1e9},
        Flight{1e-8, 0, 1e-10, 0, 1, 1e9}, Flight{0.1, 0, 0, 0.1, 2, forced_end},
        Flight{0, 0.01, 0, 0.002, 1, forced_end}, Flight{0, 0, 0, 1e-3, 0.5, forced_end}}) {
    const Scene scene{.damping_ratio = f.zeta,
                      .x0 = f.x0,
                      .force_amplitude = f.f0,
                      .force_frequency = f.omega,
                      .until_time = f.end,
                      .dampers = {{.y0 = 0.5 - f.x0, .w0 = f.w0}}};
    for (const Engine& engine : both) {
      ++none.cases;
      Watch watch;  // not simulate(), which asks for half cycles wherever impacts are wanted
      watch.sample_at = f.end;
      const Outcome outcome = observed(scene, engine, watch);
      found += watch.impacts;
      if (watch.impacts > 0 || watch.samples.empty() || outcome.stop_reason != StopReason::time) {
        none.miss(std::to_string(watch.impacts) + " impacts to t = " + full(outcome.end_time) + "; " +
                  in_full(scene, engine));
        continue;
      }
      if (f.f0 != 0) continue;
      ++phase.cases;
      const long double z = f.zeta, t = f.end, a = std::sqrt(std::abs(1 - z * z));
      const long double x =
          z < 1 ? f.x0 * std::exp(-z * t) * (std::cos(a * t) + z / a * std::sin(a * t)) : 0.0L;
      const double unit = epsilon * (f.zeta == 0 ? 1 : 1 + f.end * std::exp(-f.zeta * f.end)) * f.x0;
      const double error = double(std::abs(watch.samples[0].x - x)) / unit;
      worst.take(error);
      if (!(error <= 16)) phase.miss("x is off by " + rounded(error) + "; " + in_full(scene, engine));
    }
  }
  none.measured = std::to_string(found) + " impacts";
  phase.measured = rounded(worst);
  return {none, phase};
}

// The work that an event may take, counted in operations of the scalar: no clock, so that it is the same
// everywhere. A few hundred to a few thousand are usual.
Check crawling() {
  constexpr double allowed = 1e6;
  Check check =
      about("arithmetic operations for each search of an event, where nothing is easy to tell apart",
            rounded(allowed));
  Worst worst;
  const double least = least_magnitude;
  struct Hard {
    double x0, v0, y0, w0, e, end;
  };
  // Left at rest on a lossless wall with no more than a third derivative to go by; pressed to one; along a
  // wall.
  for (const Hard& h : {Hard{-least, 2, 0, 0, 1, 0.03}, Hard{0, 2, 0, 0, 0.6, 0.03},
                        Hard{-6, 0, 0, 0, 1, 0.1}, Hard{6, 0, 1, 0, 1, 0.1}, Hard{6, 0, 1, 0, 0, 3},
                        Hard{6, 0, 1e-15, -1e-14, 0.6, 3}, Hard{1, 0, 0, 0, 0.999999, 3}}) {
    const Scene scene{.x0 = h.x0,
                      .v0 = h.v0,
                      .until_time = h.end,
                      .dampers = {{.restitution = h.e, .y0 = h.y0, .w0 = h.w0}}};
    ++check.cases;
    const bench::Counts counts = bench::count(scene, Exact{.budget = few_impacts}).counts;
    const double operations = double(counts.sincos + counts.exponentials + counts.square_roots +
                                     counts.divisions + counts.other_arithmetic) /
                              double(counts.searches + 1);
    worst.take(operations);
    if (!(operations <= allowed))
      check.miss(rounded(operations) + " for each search; " + in_full(scene, Exact{}));
  }
  check.measured = rounded(worst);
  return check;
}

// A mass that drifts for half a thousand million radians before it meets a wall, one that stays in its wall,
// one that rests on it.
Check long_times() {
  Check check = about("impacts and contacts up to t = 1e9: the energy balance, order, the end",
                      rounded(closed_balance));
  Worst worst;
  struct Slow {
    double x0, y0, w0, e, zeta;
  };
  for (const Slow& s : {Slow{0.2, 0.5, 1e-9, 0.6, 0}, Slow{0.2, 0.5, -1e-8, 0.2, 0},
                        Slow{0.3, 0.5, 1e-9, 1, 0}, Slow{0, -0.3, 0, 0, 0}, Slow{1, -0.3, 0, 0, 0.1},
                        Slow{0, 1.2, 0, 0.6, 1e-9}, Slow{1e-9, 0.5, 1e-9, 0.6, 2}, Slow{6, 0, 0, 0.6, 3}}) {
    const Scene scene{.damping_ratio = s.zeta,
                      .x0 = s.x0,
                      .until_time = 1e9,
                      .dampers = {{.restitution = s.e, .y0 = s.y0, .w0 = s.w0}}};
    for (const Engine& engine : both) {
      if (std::holds_alternative<Restitution>(engine) && !(s.y0 >= 0 && s.y0 <= 1)) continue;
      ++check.cases;
      say("to t = 1e9: " + in_full(scene, engine));
      const Run run = simulate(scene, engine, {.half_cycles = false, .contacts = true, .energy = true});
      const double open = std::abs(run.energy->residual);
      worst.take(open);
      const bool ended = (run.stop_reason == StopReason::time && run.end_time == 1e9) ||
                         run.stop_reason == StopReason::impact_budget;
      if (!(open <= closed_balance) || !ended)
        check.miss("open by " + rounded(open) + ", " + std::to_string(run.energy->impact_loss.size()) +
                   " impacts to t = " + full(run.end_time) + "; " + in_full(scene, engine));
    }
  }
  check.measured = rounded(worst);
  return check;
}

}  // namespace

std::vector<Check> aimed_scenes(const Options& options) {
  std::vector<Check> checks{grazing(options)};
  if (options.seed) return checks;  // the others have none
  say("release on a wall");
  checks.push_back(on_a_wall());
  say("impacts within a rounding");
  checks.push_back(within_a_rounding(options));
  say("accumulation at a crossing");
  checks.push_back(accumulation_at_a_crossing());
  for (const Engine& engine : both) checks.push_back(lossless(options, engine));
  say("searches of events that crawl");
  checks.push_back(crawling());
  say("flights that meet no wall");
  for (const Check& check : no_wall(options)) checks.push_back(check);
  say("long times");
  checks.push_back(long_times());
  return checks;
}

}  // namespace stress
