#include "application/sweeps/damper_set_design.hpp"

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>

#include "application/sweeps/sampling.hpp"
#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

// Widest clearance in units of the release. The primary mass moves by twice the release in its first half
// cycle, less with the masses that it takes along; so a wall meets each mass, wherever it is in its cavity.
constexpr double widest = 1.8;

// base^exponent, base > 0, with bits that depend on no C library.
double power_of(double base, double exponent) { return exponential(exponent * logarithm(base)); }

// Loss of one damper. Without friction, weight and drag it depends on the amplitude divided by the clearance
// alone; with them, on the clearance, too: then there is one for each of `clearances`, which ascend, and the
// nearest is taken.
struct LossOfOne {
  std::vector<double> clearances;
  std::vector<LossAlone> losses;

  double at(double amplitude, double clearance) const {
    if (clearances.empty()) return losses.front().at(amplitude / clearance);
    auto nearest = std::ranges::lower_bound(clearances, clearance);
    if (nearest == clearances.end() ||
        (nearest != clearances.begin() && clearance * clearance < *nearest * *(nearest - 1)))
      --nearest;
    return losses[std::size_t(nearest - clearances.begin())].at(amplitude / *nearest);
  }
};
// With three restitutions: as designed, and at both ends of the tolerance.
struct Known {
  LossOfOne nominal, lower, higher;
};

Engine engine_of_sets() {
  Restitution engine;
  engine.budget.max_impacts = 10'000'000;
  return engine;
}

// A free decay of one damper; lengths are in units of its clearance.
Scene scene_alone(double mass_ratio, double restitution, double from, double until) {
  Scene scene;
  scene.damper().mass_ratio = mass_ratio;
  scene.damper().restitution = restitution;
  scene.x0 = from;
  scene.until_amplitude = until;
  scene.until_time = 4e5;
  return scene;
}
LossAlone measured_alone(const Scene& scene, const Threads& threads) {
  return loss_alone(simulate_ensemble(scene, engine_of_sets(), Record{}, {.members = 4, .threads = threads}));
}

double least_within(const Known& known, double amplitude, double clearance, double off) {
  double least = std::numeric_limits<double>::infinity();
  for (const LossOfOne* alone : {&known.nominal, &known.lower, &known.higher})
    for (int i = -4; i <= 4; ++i)
      least = std::min(least, alone->at(amplitude, clearance * (1 + off * i / 4)));
  return least;
}

// Returns the least eta/nu, within the tolerances, of one damper between each two edges: its column of the
// linear programme (M17.14).
std::vector<double> column_of(const Known& known, double clearance, const std::vector<double>& edges,
                              double off) {
  constexpr int parts = 4;
  std::vector<double> column;
  for (std::size_t k = 0; k + 1 < edges.size(); ++k) {
    double sum = 0;
    for (int part = 0; part < parts; ++part)
      sum += least_within(known, edges[k] * power_of(edges[k + 1] / edges[k], (part + 0.5) / parts),
                          clearance, off);
    column.push_back(sum / parts);
  }
  return column;
}

bool has_components(const DamperSetQuestion& question) {
  return question.friction > 0 || question.static_friction > 0 || question.weight > 0 || question.drag > 0;
}

// Bounds of the clearances: none is wider than `most`. The narrowest is below the one whose fold lies at the
// amplitude `lowest`: the lower end of the range or, if smaller, the fold of the widest clearance. narrowest:
// in units of that one's. With friction or weight impacts fail sooner, in a narrow cavity last.
struct Bounds {
  double fold, most, lowest, narrowest;
};
Bounds bounds_of(const DamperSetQuestion& question) {
  const double fold = fold_amplitude(question.restitution),
               most = std::min(widest * question.release, question.upper / fold);
  return {fold, most, std::min(question.to, most * fold), has_components(question) ? 0.1 : 0.4};
}

// Measures what one damper of this mass and restitution loses, with every clearance that may be tried.
LossOfOne measured_alone(const DamperSetQuestion& question, double mass_ratio, double restitution,
                         const Threads& threads) {
  const Bounds bounds = bounds_of(question);
  const double off = question.clearance_off,
               least = bounds.narrowest * bounds.lowest / bounds.fold * (1 - off);
  if (!has_components(question)) {
    // The upper amplitude in units of the narrowest clearance tried, with its tolerance; 10 % more.
    const double from = 1.1 * question.upper * bounds.fold / (bounds.narrowest * bounds.lowest) / (1 - off);
    constexpr double deep = 30;  // below its fold a mass still rattles
    return {{},
            {measured_alone(scene_alone(mass_ratio, restitution, from, fold_amplitude(restitution) / deep),
                            threads)}};
  }
  constexpr double ratio = 1.1, above = 1.2;  // of neighbours; of the release, so that `upper` is known
  LossOfOne alone;
  double c = least;
  while (c < bounds.most * (1 + off) * ratio) {
    Scene scene = scene_alone(mass_ratio, restitution, above * question.release / c, question.to / c);
    set_components(scene, question, c);
    alone.clearances.push_back(c);
    alone.losses.push_back(measured_alone(scene, threads));
    c *= ratio;
  }
  return alone;
}

std::vector<double> clearances_between(double least, double most, std::int64_t count) {
  std::vector<double> clearances;
  for (std::int64_t j = 0; j < count; ++j)
    clearances.push_back(
        rounded_to(count == 1 ? least : most * power_of(least / most, double(j) / double(count - 1)), 3));
  return clearances;
}

// The clearances whose best shares have the largest least sum, with their columns.
struct Clearances {
  std::vector<double> values;
  std::vector<std::vector<double>> columns;
  double least = -1;
};
Clearances best_clearances(const DamperSetQuestion& question, std::int64_t count, const Known& known,
                           const std::vector<double>& edges) {
  constexpr int narrow_steps = 16, wide_steps = 12;
  const Bounds bounds = bounds_of(question);
  // From the clearance whose fold is at `lowest` down to the narrowest; a single damper may need up to 30
  // times it.
  const double from = count == 1 && has_components(question) ? bounds.narrowest : 1,
               to = count == 1 ? 30 : bounds.narrowest;
  Clearances best;
  for (int narrow = 0; narrow < narrow_steps; ++narrow) {
    const double c =
        std::min(bounds.most, bounds.lowest / bounds.fold *
                                  (from * power_of(to / from, double(narrow) / (narrow_steps - 1))));
    for (int wide = 0; wide < (count == 1 ? 1 : wide_steps); ++wide) {
      const double end = bounds.most * power_of(0.3, double(wide) / wide_steps);
      if (count > 1 && !(end > c)) continue;
      Clearances tried{clearances_between(c, end, count), {}, 0};
      for (const double clearance : tried.values)
        tried.columns.push_back(column_of(known, clearance, edges, question.clearance_off));
      tried.least = best_shares(tried.columns).least;
      if (tried.least > best.least) best = std::move(tried);
    }
  }
  return best;
}

std::vector<SceneDamper> dampers_of(const DamperSetQuestion& question, const Clearances& clearances,
                                    const std::vector<double>& shares) {
  std::vector<SceneDamper> dampers;
  double sum = 0;
  for (std::size_t j = 0; j < shares.size(); ++j) {
    if (shares[j] < 1e-3) continue;
    SceneDamper& damper = dampers.emplace_back();
    damper.mass_ratio = shares[j];
    damper.restitution = question.restitution;
    damper.clearance = clearances.values[j];
    sum += shares[j];
  }
  for (SceneDamper& damper : dampers)
    damper.mass_ratio = question.mass_ratio * rounded_to(damper.mass_ratio / sum, 3);
  return dampers;
}

// Simulates sets drawn within the tolerances: each clearance by itself, the restitution, which is the
// material's, of all alike.
std::vector<Run> varied_runs(const DamperSetQuestion& question, const std::vector<SceneDamper>& dampers,
                             const Threads& threads) {
  std::vector<Scene> scenes;
  for (std::int64_t draw = 0; draw < set_draws; ++draw) {
    std::vector<SceneDamper> off = dampers;
    const auto deviation = [&](std::size_t variable) {
      return 2 * uniform_draw({1, std::uint32_t(variable), draw}) - 1;
    };
    for (std::size_t j = 0; j < off.size(); ++j) {
      off[j].clearance *= 1 + question.clearance_off * deviation(1 + j);
      off[j].restitution += question.restitution_off * deviation(0);
    }
    scenes.push_back(scene_of_set(question, off));
  }
  return simulate_scenes(scenes, engine_of_sets(), Record{}, threads);
}

std::vector<double> in_releases(std::vector<double> lengths, double release) {
  for (double& length : lengths) length /= release;
  return lengths;
}

// Returns the best set with `run`, `expected` and `worst`, but without `varied` and `one`.
DamperSet best_by_runs(const DamperSetQuestion& question, const Threads& threads,
                       const std::function<void(const std::string& doing)>& tell) {
  const double e = question.restitution;
  DamperSet set;
  set.edges = descending_amplitudes(question.upper, question.to, set_bins_in_decade);
  tell("what one damper does alone");
  // f hardly depends on the mass, and runs with a very light one take long; but drag counts by the mass.
  const double share = question.mass_ratio / double(question.count),
               alone_mass = question.drag > 0 ? share : std::clamp(share, 0.002, 0.05);
  const auto alone = [&](double restitution) {
    return measured_alone(question, alone_mass, restitution, threads);
  };
  const LossOfOne nominal = alone(e);
  const Known exactly{nominal, nominal, nominal};
  const double off = question.restitution_off;
  const Known known = off == 0 ? exactly : Known{nominal, alone(e - off), alone(e + off)};
  tell("clearances");
  Clearances clearances = best_clearances(question, question.count, known, set.edges);
  const double viscous = 2 * question.damping_ratio / (1 + question.mass_ratio);
  const auto expected_of = [&](const std::vector<SceneDamper>& dampers, const Known& with,
                               double clearance_off) {
    std::vector<double> sum(set.edges.size() - 1, viscous);
    for (const SceneDamper& damper : dampers) {
      const std::vector<double> column = column_of(with, damper.clearance, set.edges, clearance_off);
      for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += damper.mass_ratio * column[i];
    }
    return sum;
  };
  // The dampers do not quite add. Their run shows by how much, and the programme is solved again with that.
  const int passes = question.count == 1 ? 1 : 3;  // the share of one is 1
  double best = -1;
  for (int pass = 0; pass < passes; ++pass) {
    tell(filled("masses, {} of {}", pass + 1, passes));
    const std::vector<SceneDamper> dampers =
        dampers_of(question, clearances, best_shares(clearances.columns).share);
    const std::vector<Run> runs = simulate_ensemble(scene_of_set(question, dampers), engine_of_sets(),
                                                    Record{}, {.members = set_releases, .threads = threads});
    const LossSpread run = losses_between(runs, in_releases(set.edges, question.release));
    const std::vector<double> expected = expected_of(dampers, exactly, 0);
    const double least = *std::ranges::min_element(run.mean);
    if (least > best) {
      best = least;
      set.dampers = dampers;
      set.run = run;
      set.expected = expected;
    }
    for (std::size_t i = 0; i < run.mean.size(); ++i) {
      if (!(expected[i] > viscous)) continue;
      const double ratio = std::clamp((run.mean[i] - viscous) / (expected[i] - viscous), 0.5, 2.0);
      for (std::vector<double>& column : clearances.columns) column[i] *= ratio;
    }
  }
  set.worst = expected_of(set.dampers, known, question.clearance_off);
  return set;
}

}  // namespace

// With z = x/t: minimise sum_j z_j with sum_j z_j columns[j][i] >= 1. The dual, maximise sum_i w_i with sum_i
// w_i columns[j][i] <= 1, is feasible at w = 0, and the final prices of the simplex method are z. Bland's
// rule makes it end.
Shares best_shares(const std::vector<std::vector<double>>& columns) {
  const std::size_t rows = columns.front().size(), dampers = columns.size(), width = rows + dampers + 1;
  // A row for each damper: coefficients of w, slacks, right side. The last: the objective's, negated.
  std::vector<std::vector<double>> tableau(dampers + 1, std::vector<double>(width, 0.0));
  std::vector<std::size_t> basis;
  for (std::size_t j = 0; j < dampers; ++j) {
    std::ranges::copy(columns[j], tableau[j].begin());
    tableau[j][rows + j] = tableau[j][width - 1] = 1;
    basis.push_back(rows + j);
  }
  std::fill_n(tableau[dampers].begin(), rows, -1.0);
  constexpr double rounding = 1e-11;
  for (;;) {
    std::vector<double>& prices = tableau[dampers];
    const auto enters = std::size_t(
        std::find_if(prices.begin(), prices.end() - 1, [](double price) { return price < -rounding; }) -
        prices.begin());
    if (enters == width - 1) break;
    std::optional<std::size_t> leaves;
    const auto ratio = [&](std::size_t j) { return tableau[j][width - 1] / tableau[j][enters]; };
    for (std::size_t j = 0; j < dampers; ++j)
      if (tableau[j][enters] > rounding &&
          (!leaves || ratio(j) < ratio(*leaves) || (ratio(j) == ratio(*leaves) && basis[j] < basis[*leaves])))
        leaves = j;
    // No damper loses anything in some interval: the least cannot exceed 0.
    if (!leaves) return {std::vector<double>(dampers, 1.0 / double(dampers)), 0};
    basis[*leaves] = enters;
    const double pivot = tableau[*leaves][enters];
    for (double& entry : tableau[*leaves]) entry /= pivot;
    for (std::vector<double>& row : tableau) {
      const double factor = row[enters];
      if (&row == &tableau[*leaves] || factor == 0) continue;
      for (std::size_t k = 0; k < width; ++k) row[k] -= factor * tableau[*leaves][k];
    }
  }
  const double sum = tableau[dampers][width - 1];
  Shares best{{}, 1 / sum};
  for (std::size_t j = 0; j < dampers; ++j)
    best.share.push_back(std::max(0.0, tableau[dampers][rows + j]) / sum);
  return best;
}

std::vector<Problem> problems_of(const DamperSetQuestion& question) {
  std::vector<Problem> problems;
  const auto demand = [&](std::string_view field, double value, double least, double most,
                          std::string_view why = "") {
    if (!(value >= least && value <= most))
      problems.push_back(
          {std::string(field), filled("must be >= {} and <= {}{}, got {}", least, most, why, value)});
  };
  demand("release", question.release, 1e-6, 1e6);
  demand("upper", question.upper, 0, 0.9 * question.release, ", nine tenths of the release");
  demand("to", question.to, question.upper / 1000, question.upper / 2, ", half of the range's upper end");
  demand("mass_ratio", question.mass_ratio, 1e-4, 0.2, ", divided by the primary mass");
  demand("count", double(question.count), 1, double(most_set_dampers));
  demand("clearance_off", question.clearance_off, 0, 0.5);
  demand("restitution_off", question.restitution_off, 0, 0.4);
  demand("restitution", question.restitution, 0.1 + question.restitution_off, 0.9 - question.restitution_off);
  demand("damping_ratio", question.damping_ratio, 0, 0.1);
  demand("friction", question.friction, 0, 1e6);
  demand("weight", question.weight, 0, 1e6);
  if (question.static_friction != 0)
    demand("static_friction", question.static_friction, question.friction, 1e6);
  demand("drag", question.drag, 0, 1e6 * question.mass_ratio);
  if (const double held = locking_amplitude_of(question); !(question.to > held))
    problems.push_back(
        {"to", filled("must be > {}, up to which friction and weight keep these masses at rest in "
                      "cavities of any clearance, got {}",
                      rounded_text(held, 4), question.to)});
  return problems;
}

double locking_amplitude_of(const DamperSetQuestion& question) {
  const double holds = std::max(question.friction, question.static_friction);
  return locking_amplitude(1 / square_root(1 + question.mass_ratio), holds + question.weight);
}

void set_components(Scene& scene, const DamperSetQuestion& question, double length) {
  scene.weight = question.weight / length;
  for (SceneDamper& each : scene.dampers) {
    each.friction = question.friction / length;
    each.static_friction = question.static_friction / length;
    each.drag = question.drag / each.mass_ratio;
  }
}

Scene scene_of_set(const DamperSetQuestion& question, const std::vector<SceneDamper>& dampers) {
  Scene scene;
  scene.damping_ratio = question.damping_ratio;
  scene.x0 = 1;
  scene.dampers = dampers;
  for (SceneDamper& damper : scene.dampers) damper.clearance /= question.release;
  set_components(scene, question, question.release);
  scene.until_time = 1e5;
  // With friction an amplitude a little below may never be reached.
  scene.until_amplitude = (has_components(question) ? 1 : 0.9) * question.to / question.release;
  return scene;
}

DamperSet best_damper_set(const DamperSetQuestion& question, const Threads& threads,
                          const std::function<void(const std::string& doing)>& tell) {
  require_none(problems_of(question));
  DamperSet set = best_by_runs(question, threads, tell);
  tell("dampers that are off");
  set.varied =
      losses_between(varied_runs(question, set.dampers, threads), in_releases(set.edges, question.release));
  if (question.count > 1) {
    DamperSetQuestion of_one = question;
    of_one.count = 1;
    const DamperSet one =
        best_by_runs(of_one, threads, [&](const std::string& doing) { tell("of one damper: " + doing); });
    set.one = {one.dampers.front().clearance, *std::ranges::min_element(one.run.mean)};
  }
  return set;
}

}  // namespace impact_damper
