// The table of what must come out, each row computed from the run at hand.
#include <algorithm>
#include <cmath>

#include "findings.hpp"

namespace impact_damper::bench {
namespace {

std::string digits(double number, const char* format = "%.2g") {
  char text[32];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

// Where no setting reaches the error: how far the contender got, and what that took.
std::string out_of_reach(const Curve& curve) {
  const Point* best = nullptr;
  for (const Point& point : curve.points) {
    if (point.error && !(best && *best->error <= *point.error)) best = &point;
  }
  if (!best) return curve.contender + ": no comparable run";
  return curve.contender + ": never below " + digits(*best->error) + " (in " +
         digits(best->timing.seconds.median * 1e3, "%.0f") + " ms)";
}

void measure_error(const Findings& found, const std::string& scene, Target& target) {
  const Curve* exact = found.curve(scene, "exact");
  if (!exact || exact->points.empty()) return;
  target.measured = exact->finest().error;
  target.note = "in " + digits(exact->finest().timing.seconds.median * 1e3) + " ms";
}

void measure_cost(const Findings& found, const std::string& engine, Target& target) {
  const Curve* curve = found.curve("S5", engine);
  if (!curve || curve->points.empty()) return;
  const Point& point = curve->finest();
  target.measured = point.timing.yardsticks.median / double(point.impacts);
  target.note =
      std::to_string(point.impacts) + " impacts in " + digits(point.timing.seconds.median * 1e3) + " ms";
}

// How much longer the fastest of `peers` takes for `error` than the exact engine does for its own.
void measure_against(const Findings& found, const std::string& scene, const std::vector<std::string>& peers,
                     double error, Target& target) {
  const Curve* exact = found.curve(scene, "exact");
  std::optional<double> fastest;
  for (const std::string& peer : peers) {
    const Curve* curve = found.curve(scene, peer);
    if (!curve || curve->points.empty()) continue;
    const auto time = time_at(*curve, error);
    if (!time) {
      target.note += (target.note.empty() ? "" : "; ") + out_of_reach(*curve);
    } else if (!fastest || *time < *fastest) {
      fastest = time;
      target.note = peer;
    }
  }
  if (!exact || exact->points.empty()) return;
  if (fastest) {
    target.measured = *fastest / exact->finest().timing.yardsticks.median;
  } else if (target.note.empty()) {
    target.note = "not measured: this build has no such peer";
  }
}

// How much longer `fixed` takes on S5 than `two`, at the smallest error that both reach, but not below one
// and a half times what chaos scatters by, where luck would decide; and that error.
struct Ratio {
  std::optional<double> times;
  double error = 0;
};
Ratio compare_rates(const Findings& found, const std::string& fixed_name, const std::string& two_name) {
  const Curve *fixed = found.curve("S5", fixed_name), *two = found.curve("S5", two_name);
  if (!fixed || !two) return {};
  double scatter = 0;
  for (const Reference& reference : found.references) {
    if (reference.scene == "S5" && reference.walls == Walls::compliant && reference.loss_curve) {
      scatter = 1.5 * reference.loss_curve->upper;
    }
  }
  const auto a = least_error(*fixed), b = least_error(*two);
  if (!a || !b) return {};
  Ratio ratio{.error = std::max({*a, *b, scatter})};
  const auto slow = time_at(*fixed, ratio.error), fast = time_at(*two, ratio.error);
  if (slow && fast) ratio.times = *slow / *fast;
  return ratio;
}

void measure_two_rates(const Findings& found, Target& target) {
  const Ratio plain = compare_rates(found, "cem", "cem two rates");
  const Ratio located = compare_rates(found, "cem located", "cem located two rates");
  target.measured = plain.times;
  if (plain.times) target.note = "at an error of " + digits(plain.error);
  if (located.times) {
    target.note +=
        "; with events located " + digits(*located.times, "%.1f") + " x at " + digits(located.error);
  }
}

// Where the error falls regularly; held against the bound to a tenth.
void measure_order(const Findings& found, Target& target) {
  constexpr double below = 1e-5;
  const Curve* curve = found.curve("S3", "cem located");
  const auto order = curve ? observed_order(*curve, below) : std::nullopt;
  if (!order) {
    target.note = "no two errors below " + digits(below);
    return;
  }
  target.measured = std::round(*order * 10) / 10;
  target.note = digits(*order, "%.3f") + " by errors below " + digits(below);
}

void measure_flatness(const Findings& found, const std::string& engine, const std::string& against,
                      Target& target) {
  for (const Sweep& sweep : found.sweeps) {
    if (sweep.engine != engine || sweep.against != against) continue;
    const auto [least, most] = std::ranges::minmax_element(sweep.points, {}, &SweepPoint::cost);
    target.measured = most->cost() / least->cost();
    target.note = digits(least->cost(), "%.1f") + " yardsticks at " + digits(least->at) + " to " +
                  digits(most->cost(), "%.1f") + " at " + digits(most->at);
  }
}

}  // namespace

const Curve* Findings::curve(const std::string& scene, const std::string& contender) const {
  for (const Curve& each : curves) {
    if (each.scene == scene && each.contender == contender) return &each;
  }
  return nullptr;
}

std::vector<Target> targets_of(const Findings& found) {
  std::vector<Target> all;
  const auto add = [&](Target target, const auto& measure_it) {
    measure_it(target);
    all.push_back(std::move(target));
  };
  const auto at_most = [](const std::string& what, double bound, std::optional<double> aim,
                          const std::string& unit = "") {
    return Target{.what = what, .at_most = true, .bound = bound, .aim = aim, .unit = unit};
  };
  const auto at_least = [](const std::string& what, double bound, std::optional<double> aim,
                           const std::string& unit = "x") {
    return Target{.what = what, .at_most = false, .bound = bound, .aim = aim, .unit = unit};
  };

  add(at_most("exact: error on S1", 1e-11, 1e-12), [&](Target& t) { measure_error(found, "S1", t); });
  add(at_most("exact: error on S3", 1e-12, 1e-13), [&](Target& t) { measure_error(found, "S3", t); });
  add(at_most("exact: time per impact on S5, everything included, in yardsticks", 15, 7),
      [&](Target& t) { measure_cost(found, "exact", t); });
  add(at_most("restitution: time per impact on S5, in yardsticks", 8, 4),
      [&](Target& t) { measure_cost(found, "restitution", t); });

  const std::vector<std::string> odeint{"odeint fehlberg78", "odeint dopri5"};
  add(at_least("exact against the best odeint at 1e-9, S1", 10, 30),
      [&](Target& t) { measure_against(found, "S1", odeint, 1e-9, t); });
  add(at_least("exact against the best odeint at 1e-9, S3", 15, 30),
      [&](Target& t) { measure_against(found, "S3", odeint, 1e-9, t); });
  add(at_least("exact against CVODE at 1e-9, S1", 300, 1000),
      [&](Target& t) { measure_against(found, "S1", {"CVODE"}, 1e-9, t); });
  add(at_least("exact against fixed-step central differences at 1e-3, S3", 100, 300),
      [&](Target& t) { measure_against(found, "S3", {"central differences"}, 1e-3, t); });
  add(at_least("cem with events located: observed order on S3", 2, {}, ""),
      [&](Target& t) { measure_order(found, t); });
  add(at_least("cem with two rates against fixed step at equal error, S5", 20, 50),
      [&](Target& t) { measure_two_rates(found, t); });

  add(at_most("all figure scenes and all tables, in process, one core", 20, 6, "ms"), [&](Target& t) {
    t.measured = found.figures.timing.seconds.median * 1e3;
    t.note = digits(found.figures.timing.yardsticks.median, "%.0f") + " yardsticks";
  });
  for (const Allocations& counted : found.allocations) {
    add(at_most(counted.engine + ": allocations in a decay beyond the recorded columns", 0, {}),
        [&](Target& t) {
          t.measured = double(counted.quiet);
          t.note = std::to_string(counted.recorded) + " with half cycles recorded";
        });
  }
  for (const Sweep& sweep : found.sweeps) {
    add(at_most(sweep.engine + ": cost per impact against " + sweep.against + ", largest by smallest", 2, {},
                "x"),
        [&](Target& t) { measure_flatness(found, sweep.engine, sweep.against, t); });
  }
  for (const Reference& reference : found.references) {
    if (!reference.from_independent) continue;
    add(at_most("reference of " + reference.scene + ": distance from another integrator's", 1e-14, {}),
        [&](Target& t) { t.measured = reference.from_independent; });
  }
  add(at_least("an ensemble on 2 threads against 1", 1.8, {}), [&](Target& t) {
    t.measured = found.speedup.ratio.median;
    t.note = std::to_string(found.speedup.members) + " decays, by the clock on the wall";
  });
  return all;
}

}  // namespace impact_damper::bench
