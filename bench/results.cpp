// The table of results, each computed from the run at hand and held against its regression bound.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <utility>

#include "findings.hpp"
#include "impact_damper/engines/cem.hpp"

namespace impact_damper::bench {
namespace {

std::string digits(double number, const char* format = "%.2g") {
  char text[32];
  std::snprintf(text, sizeof text, format, number);
  return text;
}

std::string impacts_of(const Point& point) {
  return std::to_string(point.impacts) + " impacts in " + digits(point.timing.seconds.median * 1e3) + " ms";
}

std::string said(const Order& order) {
  return digits(order.slope, "%.2f") + " ± " + digits(order.uncertainty, "%.2f") + " by " +
         std::to_string(order.points) + " steps";
}

// Where no setting reaches the error: how far the contender got, and what that took.
std::string out_of_reach(const Curve& curve) {
  const Point* best = curve.best();
  if (!best) return curve.contender + ": no comparable run";
  return curve.contender + ": never below " + digits(*best->error) + " (in " +
         digits(best->timing.seconds.median * 1e3, "%.0f") + " ms)";
}

// What fills in a Result.
struct Measured {
  std::optional<double> measured;
  std::string note;
};

Measured measure_error(const Findings& found, const std::string& scene) {
  Measured result;
  const Curve* exact = found.curve(scene, "exact");
  if (!exact || exact->points.empty()) return result;
  result.measured = exact->finest().error;
  result.note = "in " + digits(exact->finest().timing.seconds.median * 1e3) + " ms";
  return result;
}

Measured measure_cost(const Findings& found, const std::string& scene, const std::string& engine) {
  Measured result;
  const Curve* curve = found.curve(scene, engine);
  if (!curve || curve->points.empty()) return result;
  const Point& point = curve->finest();
  result.measured = point.timing.reference_operations.median / double(point.impacts);
  result.note = impacts_of(point);
  return result;
}

// What an impact costs under a slow and a fast force, and a whole period of one so fast that impacts are
// rare.
Measured measure_frequencies(const Findings& found) {
  Measured result;
  std::vector<double> costs;
  for (const char* name : {"S8 slow", "S8 fast", "S8 very fast"}) {
    const auto scene = std::ranges::find(found.scenes, name, &BenchScene::name);
    const Curve* curve = found.curve(name, "exact");
    if (scene == found.scenes.end() || !curve || curve->points.empty()) return result;
    const double omega = scene->scene.force_frequency;
    const double periods = *scene->scene.until_time * omega / (2 * std::acos(-1.0));
    const Point& point = curve->finest();
    costs.push_back(point.timing.reference_operations.median /
                    (omega < 10 ? double(point.impacts) : periods));
    result.note += (result.note.empty() ? "" : ", ") + digits(costs.back(), "%.1f") + " at " + digits(omega);
  }
  const auto [least, most] = std::ranges::minmax_element(costs);
  result.measured = *most / *least;
  return result;
}

// How much longer the fastest of `peers` takes for `error` than the exact engine does for its own.
Measured measure_against(const Findings& found, const std::string& scene,
                         const std::vector<std::string>& peers, double error) {
  Measured result;
  const Curve* exact = found.curve(scene, "exact");
  std::optional<double> fastest;
  for (const std::string& peer : peers) {
    const Curve* curve = found.curve(scene, peer);
    if (!curve || curve->points.empty()) continue;
    const auto time = time_at(*curve, error);
    if (!time) {
      result.note += (result.note.empty() ? "" : "; ") + out_of_reach(*curve);
    } else if (!fastest || *time < *fastest) {
      fastest = time;
      result.note = peer;
    }
  }
  if (!exact || exact->points.empty()) return result;
  if (fastest) {
    result.measured = *fastest / exact->finest().timing.reference_operations.median;
  } else if (result.note.empty()) {
    result.note = "not measured: this build has no such peer";
  }
  return result;
}

// How much longer the fixed step of the paper, events not located, takes on S5 than the faster of the two
// with two rates, both for the smallest error above the sampling scatter. Beside it the same with events
// located, and the fixed step that is the default, whose own error is below that.
Measured measure_two_rates(const Findings& found) {
  Measured result;
  const auto is_s5 = [](const Reference& r) {
    return r.scene == "S5" && r.walls == Walls::compliant && r.loss_curve;
  };
  const auto reference = std::ranges::find_if(found.references, is_s5);
  if (reference == found.references.end()) return result;
  const double error = reference->loss_curve->scatter_limit();
  const auto time_of = [&](const std::string& name) {
    const Curve* curve = found.curve("S5", name);
    return curve ? time_at(*curve, error) : std::nullopt;
  };
  std::optional<double> fast;
  for (const char* name : {"cem two rates", "cem located two rates"}) {
    const auto time = time_of(name);
    if (time && !(fast && *fast <= *time)) {
      fast = time;
      result.note = std::string(name) + ", at an error of " + digits(error);
    }
  }
  const Curve* fixed = found.curve("S5", "cem");
  if (!fast || !fixed) return result;
  if (const auto slow = time_of("cem")) result.measured = *slow / *fast;
  if (const auto located = time_of("cem located")) {
    result.note += "; against cem located " + digits(*located / *fast, "%.1f") + " x";
  }
  const auto scene = std::ranges::find(found.scenes, "S5", &BenchScene::name);
  if (scene == found.scenes.end()) return result;
  for (const Point& point : fixed->points) {
    if (point.setting != *resolved(scene->scene, Cem{}).time_step || !point.error) continue;
    result.note += "; against cem at its default step (error " + digits(*point.error) + ") " +
                   digits(point.timing.reference_operations.median / *fast, "%.1f") + " x";
  }
  return result;
}

// Where the error falls regularly: above, which impacts a step separates still decides. Held against the
// bound to a tenth.
Measured measure_order(const Findings& found) {
  Measured result;
  constexpr double below = 1e-5;
  const auto order_of = [&](const std::string& name) {
    const Curve* curve = found.curve("S3", name);
    return curve ? observed_order(*curve, below) : std::nullopt;
  };
  const auto one = order_of("cem located"), two = order_of("cem located two rates");
  if (one) {
    result.measured = std::round(one->slope * 10) / 10;
    result.note = said(*one) + ", errors below " + digits(below);
  } else {
    result.note = "no four errors below " + digits(below);
  }
  if (two) result.note += "; with two rates " + said(*two);
  return result;
}

// Where the steps fall by an impact decides the error of central differences near 1e-3, so that a coarse step
// may meet it by chance: what counts is the step from which on it is met for good.
Measured measure_central_differences(const Findings& found) {
  Measured result;
  constexpr double error = 1e-3;
  const Curve *exact = found.curve("S3", "exact"), *peer = found.curve("S3", "central differences");
  if (!exact || exact->points.empty() || !peer) return result;
  const double own = exact->finest().timing.reference_operations.median;
  const auto first = time_at(*peer, error), for_good = time_for_good(*peer, error);
  if (for_good) {
    result.measured = *for_good / own;
    result.note =
        "from where on the error stays below; first below it " + digits(*first / own, "%.1f") + " x";
  } else {
    result.note = out_of_reach(*peer);
  }
  const Curve* cem = found.curve("S3", "cem");
  const auto own_cem = cem ? time_for_good(*cem, error) : std::nullopt;
  if (own_cem) result.note += "; cem, the same scheme, " + digits(*own_cem / own, "%.1f") + " x";
  return result;
}

Measured measure_flatness(const Findings& found, const std::string& engine, const std::string& against) {
  Measured result;
  for (const Sweep& sweep : found.sweeps) {
    if (sweep.engine != engine || sweep.against != against) continue;
    const auto [least, most] = std::ranges::minmax_element(sweep.points, {}, &SweepPoint::cost);
    result.measured = most->cost() / least->cost();
    result.note = digits(least->cost(), "%.1f") + " reference operations at " + digits(least->at) + " to " +
                  digits(most->cost(), "%.1f") + " at " + digits(most->at);
  }
  return result;
}

}  // namespace

const Curve* Findings::curve(const std::string& scene, const std::string& contender) const {
  for (const Curve& each : curves) {
    if (each.scene == scene && each.contender == contender) return &each;
  }
  return nullptr;
}

std::vector<DamperCost> damper_costs(const Findings& found, const std::string& engine) {
  std::vector<DamperCost> all;
  for (const BenchScene& scene : found.scenes) {
    const Curve* curve = scene.dampers > 0 ? found.curve(scene.name, engine) : nullptr;
    if (!curve || curve->points.empty()) continue;
    const Point& point = curve->finest();
    const double cost = point.timing.reference_operations.median / double(point.impacts) *
                        found.reference_operation.median * 1e9;
    const bool list = !has_one_damper(scene.scene);
    if (list && all.empty()) break;
    all.push_back({scene.dampers, list, curve, cost, list ? all[0].cost + 20 * (scene.dampers - 1) : cost});
  }
  return all;
}

std::vector<Result> results_of(const Findings& found) {
  std::vector<Result> all;
  const auto add = [&](Result result, Measured by) {
    result.measured = by.measured;
    result.note = std::move(by.note);
    all.push_back(std::move(result));
  };
  const auto at_most = [](const std::string& what, double bound, const std::string& unit = "") {
    return Result{.what = what, .at_most = true, .bound = bound, .unit = unit};
  };
  const auto at_least = [](const std::string& what, double bound, const std::string& unit = "x") {
    return Result{.what = what, .at_most = false, .bound = bound, .unit = unit};
  };

  add(at_most("exact: error on S1", 1e-11), measure_error(found, "S1"));
  add(at_most("exact: error on S3", 1e-12), measure_error(found, "S3"));
  for (const std::string scene : {"S4", "S7", "S8 slow", "S8 fast", "S8 very fast"}) {
    add(at_most("exact: error on " + scene + ", forced", 1e-12), measure_error(found, scene));
  }
  add(at_most("exact: time per impact on S5, everything included, in reference operations", 15),
      measure_cost(found, "S5", "exact"));
  add(at_most("restitution: time per impact on S5, in reference operations", 8),
      measure_cost(found, "S5", "restitution"));
  for (const std::string scene : {"S4", "S7"}) {
    add(at_most("exact: time per impact on " + scene + ", forced, in reference operations", 20),
        measure_cost(found, scene, "exact"));
    add(at_most("restitution: time per impact on " + scene + ", forced, in reference operations", 12),
        measure_cost(found, scene, "restitution"));
  }
  add(at_most("exact: time per impact, at 50 per period, on S8, largest by smallest", 3, "x"),
      measure_frequencies(found));

  for (const std::string engine : {"exact", "restitution"}) {
    for (const DamperCost& cost : damper_costs(found, engine)) {
      if (!cost.list) continue;
      add(at_most(engine + ": time per impact on S9, list of " + std::to_string(cost.dampers), cost.bound,
                  "ns"),
          {cost.cost, impacts_of(cost.curve->finest())});
    }
  }

  const std::vector<std::string> odeint{"odeint fehlberg78", "odeint dopri5"};
  add(at_least("exact against the best odeint at 1e-9, S1", 10), measure_against(found, "S1", odeint, 1e-9));
  add(at_least("exact against the best odeint at 1e-9, S3", 15), measure_against(found, "S3", odeint, 1e-9));
  add(at_least("exact against the best odeint at 1e-9, S4", 25), measure_against(found, "S4", odeint, 1e-9));
  add(at_least("exact against the best odeint at 1e-6, S4", 15), measure_against(found, "S4", odeint, 1e-6));
  add(at_least("exact against CVODE at 1e-9, S1", 300), measure_against(found, "S1", {"CVODE"}, 1e-9));
  add(at_least("exact against fixed-step central differences at 1e-3, S3", 100),
      measure_central_differences(found));
  add(at_least("cem with events located: observed order on S3", 2, ""), measure_order(found));
  add(at_least("cem with two rates against fixed step at equal error, S5", 20), measure_two_rates(found));

  add(at_most("all figure scenes and all tables, in process, one core", 20, "ms"),
      found.figures ? Measured{found.figures->timing.seconds.median * 1e3,
                               digits(found.figures->timing.reference_operations.median, "%.0f") +
                                   " reference operations"}
                    : Measured{});
  for (const Allocations& counted : found.allocations) {
    add(at_most(counted.engine + ": allocations in a decay beyond the recorded columns", 0),
        {double(counted.quiet), std::to_string(counted.recorded) + " with half cycles recorded"});
  }
  for (const Sweep& sweep : found.sweeps) {
    add(at_most(sweep.engine + ": cost per impact against " + sweep.against + ", largest by smallest", 2,
                "x"),
        measure_flatness(found, sweep.engine, sweep.against));
  }
  for (const Reference& reference : found.references) {
    if (!reference.from_independent) continue;
    add(at_most("reference of " + reference.scene + ": distance from another integrator's", 1e-14),
        {reference.from_independent, ""});
  }
  add(at_least("an ensemble on 2 threads against 1", 1.8),
      found.speedup ? Measured{found.speedup->ratio.median,
                               std::to_string(found.speedup->members) +
                                   " decays, by the clock on the wall; two ensembles side by side, which "
                                   "share nothing: " +
                                   digits(found.speedup->side_by_side.median, "%.2f") + " x"}
                    : Measured{});
  for (const ManyRuns& many : found.many_runs) {
    const std::string sweep = "a sweep of decays that keeps " + many.kept + ": ";
    add(at_most(sweep + "a million on 2 threads", many.bound, "min"),
        {many.million_minutes(), "by " + std::to_string(many.runs) + " decays, " +
                                     digits(many.one.median / double(many.runs) * 1e3) +
                                     " ms each on one thread"});
    add(at_least(sweep + "2 threads against 1", 1.9), {many.ratio.median, ""});
    add(at_most(sweep + "its own time by the engine's", 3, "%"),
        {100 * many.overhead.median, "quartiles " + digits(100 * many.overhead.lower, "%.1f") + " to " +
                                         digits(100 * many.overhead.upper, "%.1f") +
                                         "; beside it the analysis of the runs " +
                                         digits(100 * many.analysis.median, "%.1f") + " %"});
  }
  for (const ComponentCost& cost : found.components) {
    add(at_most(cost.engine + ": time per event with " + cost.component + " by that without", cost.bound,
                "x"),
        {cost.per_event.median, "quartiles " + digits(cost.per_event.lower) + " to " +
                                    digits(cost.per_event.upper) + "; per impact " +
                                    digits(cost.per_impact.median)});
  }
  for (const FunctionCost& function : found.functions) {
    add(at_most(function.name + ", " + function.arguments + ": time by the C library's", 1.5, "x"),
        {function.ratio.median, digits(function.own.median * 1e9) + " ns, error " +
                                    digits(function.own_error, "%.2f") + " ulp; there " +
                                    digits(function.library_error, "%.2f")});
  }
  return all;
}

}  // namespace impact_damper::bench
