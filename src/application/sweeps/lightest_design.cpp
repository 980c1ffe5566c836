#include "application/sweeps/lightest_design.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <tuple>
#include <utility>

#include "impact_damper/analysis/design.hpp"
#include "impact_damper/analysis/theory.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/engines/checked.hpp"
#include "impact_damper/io/json_parts.hpp"
#include "impact_damper/io/run_file.hpp"

namespace impact_damper {
namespace {

// Ratios of what is tried in turn.
struct Steps {
  double coarse_mass, mass, clearance;
};
constexpr Steps decay_steps{1.1, 1.01, 1.05}, forced_steps{1.2, 1.04, 1.1};
// Late draws to be expected if exactly the required share were in time; this decides how many are drawn.
constexpr double late_draws = 20;
// Fractions of the time and of the widest clearance for which designs are searched.
constexpr std::array<std::pair<double, double>, 5> fractions{
    {{1, 1}, {1, 0.5}, {1, 0.25}, {0.8, 1}, {0.6, 1}}};
constexpr double least_part = 1e-9;  // of the primary mass: a secondary mass without effect
constexpr double time_step = 1.05;   // ratio of successive times tried where no design is in time

// Draws of a design in the search under a force, where a draw takes a hundred times as long.
constexpr std::int64_t forced_draws = 40;
// Frequencies at which a draw in the search is looked at before all.
constexpr std::int64_t few_frequencies = 5;
// A check under a force ends after a number of neighbours that this divides, if it cannot confirm any more.
constexpr std::int64_t forced_batch = 50;
// Heavier designs that are searched for because the check does not confirm the one before.
constexpr int most_heavier = 8;

std::int64_t draws_of_search(const DesignQuestion& question) {
  return question.forced ? forced_draws : std::int64_t(std::floor(late_draws / (1 - question.share) + 0.5));
}
std::int64_t late_allowed_in_search(const DesignQuestion& question) {
  const std::int64_t late = late_allowed_of(draws_of_search(question), question.share);
  return question.forced ? std::max<std::int64_t>(0, late) : late;
}
const Steps& steps_of(const DesignQuestion& question) { return question.forced ? forced_steps : decay_steps; }

double rounded(double value) { return rounded_to(value, 3); }

GridAxis axis_of(std::string_view name, std::vector<double> values) {
  SceneFile any;
  any.in_units.emplace();
  const std::vector<Variable> variables = variables_of(any);
  GridAxis axis;
  axis.variable = *std::ranges::find(variables, name, &Variable::name);
  axis.values = std::move(values);
  return axis;
}

KeptQuantity quantity_of(const std::string& text) { return *read_quantity(text).kept; }
KeptQuantity time_below(double amplitude) {
  return quantity_of("time_to_amplitude=" + number_text(amplitude));
}

KeptNumbers made(const Plan& plan, std::int64_t i) { return kept_of(plan, run_of(plan, i)); }

// A requirement: the first quantity of a plan's runs, and what it may be at most.
struct Demand {
  Plan plan;
  double most = 0;
};
// Returns the requirements on the draws of a design, those whose runs are short first.
std::vector<Demand> demands_of(const DesignQuestion& question, const Design& design) {
  std::vector<Demand> demands;
  if (question.has_decay)
    demands.push_back(
        {search_plan(question, question.time, {design.secondary_mass}, {design.clearance}), question.time});
  if (question.forced)
    for (const std::int64_t count : {few_frequencies, forced_frequencies})
      demands.push_back({forced_plan(question, design, draws_of_search(question), question.seed, count),
                         question.forced->amplitude});
  return demands;
}

// Returns the end of the runs of a check, s; steady motions have none.
double until_of_check(const DesignQuestion& question) {
  return question.has_decay ? longest_followed * question.time : 1;
}

// Returns the question with a time and an amplitude that are `factor` times as large.
DesignQuestion relaxed(DesignQuestion question, double factor) {
  question.time *= factor;
  if (question.forced) question.forced->amplitude *= factor;
  return question;
}

FoundDesign found_by(const DesignQuestion& asked, const Design& design) {
  return {asked.has_decay ? asked.time : 0,
          asked.clearance.most,
          asked.forced ? asked.forced->amplitude : 0,
          design,
          {}};
}

class DesignSearch {
 public:
  DesignSearch(const DesignQuestion& question, const Threads& threads,
               const std::function<void(const std::string&)>& tell, std::atomic<std::int64_t>& runs)
      : question_(question), threads_(threads), tell_(tell), runs_(runs) {}

  // Returns the lightest design in time, absent if there is none. The masses tried ascend in coarse steps,
  // then in fine ones from the last coarse mass that was late.
  std::optional<Design> lightest() {
    const std::vector<double> coarse = steps_between(question_.secondary_mass, steps_.coarse_mass);
    const auto found = first_of(coarse, question_);
    if (!found || found->mass == 0) return design_of(coarse, found);
    std::vector<double> fine = steps_between({coarse[found->mass - 1], coarse[found->mass]}, steps_.mass);
    fine.erase(fine.begin());
    fine.pop_back();
    const auto lighter = fine.empty() ? std::nullopt : first_of(fine, question_);
    return lighter ? design_of(fine, lighter) : design_of(coarse, found);
  }

  // Returns the heaviest mass with the shortest of the times time * time_step^n that it keeps, amplitudes
  // under a force likewise.
  std::optional<FoundDesign> soonest() {
    double factor = 1;
    while (factor <= longest_followed) {
      const DesignQuestion asked = relaxed(question_, factor);
      const std::vector<double> heaviest{asked.secondary_mass.most};
      if (const auto found = design_of(heaviest, first_of(heaviest, asked))) return found_by(asked, *found);
      factor *= time_step;
    }
    return std::nullopt;
  }

 private:
  // Indices of a mass, in a list of them, and of one of the clearances.
  struct Place {
    std::size_t mass, clearance;
  };
  std::optional<Design> design_of(const std::vector<double>& masses, const std::optional<Place>& at) const {
    return at ? std::optional(Design{masses[at->mass], clearances_[at->clearance]}) : std::nullopt;
  }
  // The draws of one design so far, each by its largest number in units of what it may be: it is late if that
  // is > 1 (M15.16). They end with the one that is one too many late.
  struct Drawn {
    std::vector<Demand> demands;
    std::vector<double> needs;
    std::int64_t late = 0;
    double mean = 0;  // of the first first_draws_ needs
  };

  // Returns the lightest of ascending masses for which a clearance is in time, with its soonest clearance
  // (M15.10).
  std::optional<Place> first_of(const std::vector<double>& masses, const DesignQuestion& asked) {
    for (std::size_t m = 0; m < masses.size(); ++m) {
      const double limit = asked.forced ? asked.forced->amplitude : asked.time;
      tell_(filled("searched for {} with a secondary mass of {}, {} runs so far", rounded_text(limit, 3),
                   rounded_text(masses[m], 3), runs_.load()));
      if (const auto best = soonest_of(masses[m], asked)) return Place{m, *best};
    }
    return std::nullopt;
  }

  // Returns the clearance with the least need_of_most() among those in time, absent if there is none. A few
  // draws of each show which is likely the soonest; its need then ends the draws of slower ones early.
  std::optional<std::size_t> soonest_of(double mass, const DesignQuestion& asked) {
    std::vector<Drawn> drawn(clearances_.size());
    const auto is_late = [&](const Drawn& each) { return each.late > late_allowed_; };
    for_each_index(std::ssize(drawn), threads_, [&](std::int64_t c) {
      Drawn& each = drawn[std::size_t(c)];
      each.demands = demands_of(asked, {mass, clearances_[std::size_t(c)]});
      draw_more(first_draws_, 1, each, 1);
      each.mean = std::accumulate(each.needs.begin(), each.needs.end(), 0.0) / double(each.needs.size());
    });
    const auto likely = std::ranges::min_element(drawn, {}, [&](const Drawn& each) {
      return is_late(each) ? std::numeric_limits<double>::infinity() : each.mean;
    });
    if (is_late(*likely)) return std::nullopt;
    draw_more(draws_, 1, *likely, threads_);
    const double latest = is_late(*likely) ? 1 : need_of_most(*likely);
    for_each_index(std::ssize(drawn), threads_, [&](std::int64_t c) {
      if (!is_late(drawn[std::size_t(c)])) draw_more(draws_, latest, drawn[std::size_t(c)], 1);
    });
    std::optional<std::size_t> best;
    for (std::size_t c = 0; c < drawn.size(); ++c)
      if (!is_late(drawn[c]) && !(best && need_of_most(drawn[*best]) <= need_of_most(drawn[c]))) best = c;
    return best;
  }

  // Draws until there are `draws` in all, or until too many of them need more than `latest`. Some are made at
  // a time if there are `threads` for that; those behind the last one are dropped.
  void draw_more(std::int64_t draws, double latest, Drawn& drawn, const Threads& threads) {
    constexpr std::int64_t most_ahead = 8;
    drawn.late = std::ranges::count_if(drawn.needs, [&](double need) { return need > latest; });
    const std::int64_t before = std::ssize(drawn.needs);
    while (std::ssize(drawn.needs) < draws && drawn.late <= late_allowed_) {
      const std::int64_t next = std::ssize(drawn.needs);
      std::vector<double> ahead(std::size_t(std::min(draws - next, number_of(threads) > 1 ? most_ahead : 1)));
      for_each_index(std::ssize(ahead), threads, [&](std::int64_t i) {
        ahead[std::size_t(i)] = need_of(drawn.demands, next + i, latest);
      });
      for (const double need : ahead) {
        if (drawn.late > late_allowed_) break;
        drawn.needs.push_back(need);
        drawn.late += need > latest ? 1 : 0;
      }
    }
    runs_ += std::ssize(drawn.needs) - before;
  }
  // Returns the largest number of a draw in units of what it may be, or the first above `latest`.
  static double need_of(const std::vector<Demand>& demands, std::int64_t draw, double latest) {
    double need = 0;
    for (const Demand& each : demands) {
      const auto number = made(each.plan, draw).numbers[0];
      need = std::max(need, number ? *number / each.most : std::numeric_limits<double>::max());
      if (need > latest) break;
    }
    return need;
  }

  // Returns the need that all draws except those that may be late have at most.
  double need_of_most(Drawn& drawn) const {
    const auto most = drawn.needs.end() - 1 - late_allowed_;
    std::ranges::nth_element(drawn.needs, most);
    return *most;
  }

  const DesignQuestion& question_;
  const Threads& threads_;
  const std::function<void(const std::string&)>& tell_;
  std::atomic<std::int64_t>& runs_;
  const Steps& steps_ = steps_of(question_);
  const std::vector<double> clearances_ = steps_between(question_.clearance, steps_.clearance);
  const std::int64_t draws_ = draws_of_search(question_), first_draws_ = draws_ / 20,
                     late_allowed_ = late_allowed_in_search(question_);
};

// Returns the value that the question's share of ascending values is within; absent if it is infinite.
std::optional<double> value_of_share(const std::vector<double>& values, double share) {
  const double value = values[std::size_t(std::ceil(share * double(values.size()))) - 1];
  return std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// A neighbour: its largest steady amplitude and its time are infinite where it has none.
struct Neighbour {
  double time = 0, impact_speed = 0;
  std::optional<double> wall_force;
  SteadyPeak peak;
};
Neighbour neighbour_of(const Plan* decay, const Plan* forced, std::int64_t i) {
  constexpr double never = std::numeric_limits<double>::infinity();
  Neighbour found;
  if (decay) {
    const KeptNumbers kept = made(*decay, i);
    found.time = kept.numbers[0].value_or(never);
    found.impact_speed = kept.numbers[1].value_or(0);
    found.wall_force = kept.numbers[2];
  }
  if (forced) {
    const KeptNumbers kept = made(*forced, i);
    found.peak = {kept.numbers[0].value_or(never), kept.numbers[1].value_or(0)};
  }
  return found;
}

DesignCheck checked(const DesignQuestion& question, const FoundDesign& found, const Threads& threads) {
  std::optional<Plan> decay, forced;
  if (question.has_decay) decay = check_plan(question, found.design);
  if (question.forced) forced = forced_check_plan(question, found.design);
  const auto neighbour = [&](const std::optional<Plan>& of_decay, const std::optional<Plan>& of_forced,
                             std::int64_t i) {
    return neighbour_of(of_decay ? &*of_decay : nullptr, of_forced ? &*of_forced : nullptr, i);
  };
  DesignCheck check;
  {
    std::optional<Plan> decays_alone = decay, forced_alone = forced;
    for (auto* plan : {&decays_alone, &forced_alone})
      if (*plan) (*plan)->samples.reset();
    const Neighbour nominal = neighbour(decays_alone, forced_alone, 0);
    if (decay && std::isfinite(nominal.time)) check.nominal_time = nominal.time;
    if (forced && std::isfinite(nominal.peak.amplitude)) check.nominal_peak = nominal.peak;
  }

  std::vector<Neighbour> neighbours;
  const std::int64_t most = question.most_enlarged * question.neighbours;
  const std::int64_t most_late = late_allowed_of(most, question.share);
  // A design under a force that is lost early needs no more draws, one that is not decided more of them.
  std::int64_t count = question.forced ? std::min(forced_batch, question.neighbours) : question.neighbours;
  for (;;) {
    const std::int64_t before = std::ssize(neighbours);
    neighbours.resize(std::size_t(count));
    for_each_index(count - before, threads, [&](std::int64_t i) {
      neighbours[std::size_t(before + i)] = neighbour(decay, forced, before + i);
    });
    for (std::int64_t i = before; i < count; ++i) {
      const Neighbour& each = neighbours[std::size_t(i)];
      check.in_time += (!decay || each.time <= (forced ? question.time : found.time)) &&
                               (!forced || each.peak.amplitude <= question.forced->amplitude)
                           ? 1
                           : 0;
    }
    check.share = interval_of_share(check.in_time, count);
    check.confirmed = count >= question.neighbours && check.share.low >= question.share;
    check.rejected = check.share.high < question.share;
    const bool is_lost = check.rejected || (forced && count - check.in_time > most_late);
    if (is_lost || check.confirmed || count >= most) break;
    count += count < question.neighbours ? std::min(forced_batch, question.neighbours - count)
                                         : question.neighbours;
  }
  check.neighbours = count;

  std::vector<double> times, amplitudes;
  for (const Neighbour& each : neighbours) {
    times.push_back(each.time);
    amplitudes.push_back(each.peak.amplitude);
    check.largest_impact_speed = std::max(check.largest_impact_speed, each.impact_speed);
    if (each.wall_force)
      check.largest_wall_force = std::max(check.largest_wall_force.value_or(0), *each.wall_force);
  }
  std::ranges::sort(times);
  std::ranges::sort(amplitudes);
  if (decay) {
    check.slowest = value_of_share(times, 1);
    check.time_of_share = value_of_share(times, question.share);
  }
  if (forced) {
    for (const Neighbour& each : neighbours)
      if (!std::isfinite(each.peak.amplitude))
        ++check.not_steady;
      else if (!(check.worst_peak && each.peak.amplitude <= check.worst_peak->amplitude))
        check.worst_peak = each.peak;
    check.amplitude_of_share = value_of_share(amplitudes, question.share);
  }
  return check;
}

// Returns the largest factor, 1 or above, by which a tolerance makes a number larger.
double largest_factor(const DesignQuestion& question, std::string_view name, double value) {
  for (const SampledNumber& each : question.tolerances)
    if (each.variable.name == name) return 1 + (each.relative ? each.width : each.width / value);
  return 1;
}

// Returns the frequencies, within those asked for, at which the component of x at the force's frequency can
// be larger than the amplitude (M15.17), as a range of `count`.
FrequencyRange frequencies_of(const DesignQuestion& question, const Design& design, std::int64_t count) {
  constexpr int points = 1000;
  const ForcedDemand& forced = *question.forced;
  const SceneInUnits scene = *scene_of_design(question, design, 1).in_units;
  const double unit = scales_of(scene).of(Dimension::frequency);
  const double zeta = dimensionless(scene).damping_ratio;
  const double nu =
      design.secondary_mass * largest_factor(question, "secondary_mass", design.secondary_mass) / *scene.mass;
  const double clearance = design.clearance * largest_factor(question, "clearance", design.clearance);
  const double deflection = 1e3 * forced.force / *stiffness_of(scene);  // mm
  // Where mass and stiffness may be off, natural frequencies differ by half of the sum.
  const double off =
      (largest_factor(question, "mass", *scene.mass) +
       largest_factor(question, "stiffness", *stiffness_of(scene)) +
       2 * largest_factor(question, "natural_frequency", scene.natural_frequency.value_or(1)) - 4) /
      2;
  const double step = (forced.most - forced.least) / points;
  double from = forced.most, to = forced.least, largest = 0, at = forced.least;
  for (int i = 0; i <= points; ++i) {
    const double f = forced.least + i * step, w2 = f / unit * (f / unit);
    const double impedance = std::sqrt((1 - w2) * (1 - w2) + 4 * zeta * zeta * w2) - nu * w2;
    const double input = deflection + nu * w2 * 2 * clearance / std::numbers::pi;
    const double bound = impedance > 0 ? input / impedance : std::numeric_limits<double>::infinity();
    if (bound > largest) largest = bound, at = f;
    if (bound > forced.amplitude) from = std::min(from, f), to = std::max(to, f);
  }
  if (from > to) from = to = at;
  return {std::max(forced.least, rounded_to((from - step) * (1 - off), 5)),
          std::min(forced.most, rounded_to((to + step) * (1 + off), 5)), count};
}

}  // namespace

// (M15.9).
ShareInterval interval_of_share(std::int64_t count, std::int64_t of) {
  constexpr double z = 1.959963984540054;  // 95 % of a normal distribution lie within z standard deviations
  const double n = double(of), p = double(count) / n, z2 = z * z;
  const double middle = (p + z2 / (2 * n)) / (1 + z2 / n);
  const double half = z / (1 + z2 / n) * std::sqrt(p * (1 - p) / n + z2 / (4 * n * n));
  return {count == 0 ? 0 : middle - half, count == of ? 1 : middle + half};
}

std::int64_t late_allowed_of(std::int64_t draws, double share) {
  std::int64_t late = -1;
  while (late + 1 <= draws && interval_of_share(draws - late - 1, draws).low >= share) ++late;
  return late;
}

std::int64_t least_neighbours_of(double share) {
  std::int64_t draws = 1;
  while (late_allowed_of(draws, share) < 0) ++draws;
  return draws;
}

// (M15.11).
std::vector<double> steps_between(DesignRange range, double ratio) {
  std::vector<double> values{range.least};
  double value = range.least;
  while ((value *= ratio) < range.most) {
    const double next = rounded(value);
    if (next > values.back() && next < range.most) values.push_back(next);
  }
  if (range.most > values.back()) values.push_back(range.most);
  return values;
}

// (M15.12).
std::optional<double> failing_clearance(double amplitude, double restitution) {
  return restitution < 1 ? std::optional(amplitude / fold_amplitude(restitution)) : std::nullopt;
}

std::int64_t forced_neighbours_of(double share) {
  return std::max<std::int64_t>(200, std::int64_t(std::floor(4 / (1 - share) + 0.5)));
}

double least_amplitude_of(const DesignQuestion& question) {
  if (!question.forced) return question.amplitude;
  const double forced = question.forced->amplitude;
  return question.has_decay ? std::min(question.amplitude, forced) : forced;
}

// (M15.14).
double locking_amplitude_of(const DesignQuestion& question, double secondary_mass) {
  const SceneInUnits scene = *scene_of_design(question, {secondary_mass, 1}, 1).in_units;
  const Scene plain = dimensionless(scene);
  return scales_of(scene).length * locking_amplitude(1 / std::sqrt(1 + plain.damper().mass_ratio),
                                                     plain.damper().holding() + plain.weight);
}

DesignRange default_masses(const DesignQuestion& question) {
  constexpr double below = 0.99;  // far enough from the mass that is just held
  const double mass = *question.scene.mass;
  DesignRange masses{rounded(least_mass_ratio * mass), rounded(most_mass_ratio * mass)};
  // The amplitude grows in proportion to 1 + nu.
  if (const double held = locking_amplitude_of(question, masses.least); held > 0) {
    const double most = rounded(below * (least_amplitude_of(question) / held * (mass + masses.least) - mass));
    if (most > masses.least) masses.most = std::min(masses.most, most);
  }
  return masses;
}

DesignRange default_clearances(double amplitude, double restitution) {
  constexpr double most = 100;
  const auto failing = failing_clearance(amplitude, restitution);
  return {amplitude,
          rounded(std::min(most * amplitude, failing ? *failing / least_margin : most * amplitude))};
}

SceneInUnits with_unit_scales(const Scene& scene) {
  SceneInUnits units;
  units.mass = units.stiffness = 1;
  DamperInUnits& damper = units.damper();
  damper.clearance = 1;
  damper.secondary_mass = scene.damper().mass_ratio;
  damper.restitution = scene.damper().restitution;
  damper.contact_stiffness = scene.damper().wall_stiffness;
  damper.secondary_displacement = scene.damper().y0;
  damper.secondary_velocity = scene.damper().w0;
  units.damping_ratio = scene.damping_ratio;
  units.initial_displacement = scene.x0;
  units.initial_velocity = scene.v0;
  const Scales scales = scales_of(units);
  units.exciting_force = scene.force_amplitude * scales.of(Dimension::force);
  if (!has_components(scene)) return units;
  // Weight needs an inclination, of which 45 degrees leave friction the same gravity (M18.2).
  const bool is_level = scene.weight == 0;
  const double across = is_level ? 1 : scene.weight;
  units.gravity = (is_level ? 1 : scene.weight * std::numbers::sqrt2) * scales.of(Dimension::acceleration);
  units.inclination = is_level ? 0 : 45;
  damper.friction_coefficient = scene.damper().friction / across;
  damper.static_friction_coefficient = scene.damper().static_friction / across;
  damper.drag = scene.damper().drag * scene.damper().mass_ratio * scales.of(Dimension::damping) / 2;
  return units;
}

SceneInUnits with_defaults(SceneInUnits scene) {
  const Scene otherwise;
  if (!scene.damper().restitution) scene.damper().restitution = otherwise.damper().restitution;
  if (!scene.damping && !scene.damping_ratio) scene.damping_ratio = otherwise.damping_ratio;
  if (const auto stiffness = stiffness_of(scene); stiffness && !scene.damper().contact_stiffness)
    scene.damper().contact_stiffness = otherwise.damper().wall_stiffness * *stiffness;
  for (auto* number : {&scene.initial_displacement, &scene.initial_velocity})
    if (!*number) *number = 0;
  return scene;
}

namespace {

// Returns the problem of an amplitude at which friction and weight hold the lightest mass of the question, or
// else the heaviest, with what would suffice.
std::optional<Problem> problem_of_locking(const DesignQuestion& question) {
  const double asked = least_amplitude_of(question);
  const auto& [lightest, heaviest] = question.secondary_mass;
  const double mass = asked > locking_amplitude_of(question, lightest) ? heaviest : lightest;
  const double held = locking_amplitude_of(question, mass);
  if (asked > held || held == 0) return std::nullopt;
  DesignQuestion smooth = question;
  DamperInUnits& damper = smooth.scene.damper();
  double coefficient = damper.static_friction_coefficient.value_or(0);
  if (coefficient == 0) coefficient = damper.friction_coefficient.value_or(0);
  damper.friction_coefficient = damper.static_friction_coefficient = 0;
  const double by_weight = locking_amplitude_of(smooth, mass), left = asked - by_weight;
  constexpr double below = 0.994;  // so that it is not held with what is told either, in three digits
  const std::string sufficient =
      left <= 0           ? filled("its weight alone holds it up to {}, only a flatter cavity would do",
                                   rounded_text(by_weight, 4))
      : question.in_units ? filled("with a coefficient of friction of {} it would move there",
                                   rounded_text(below * coefficient * left / (held - by_weight), 3))
                          : filled("with a friction of {} it would move there",
                                   rounded_text(below * left / (1 + mass / *question.scene.mass), 3));
  return Problem{question.has_decay && asked == question.amplitude ? "amplitude" : "forced_amplitude",
                 filled("must be > {}, up to which {} a secondary mass of {} at rest in a cavity of any "
                        "clearance, got {}: {}",
                        rounded_text(held, 4),
                        by_weight == 0     ? "friction keeps"
                        : coefficient == 0 ? "its weight keeps"
                                           : "friction and weight keep",
                        mass, asked, sufficient)};
}

}  // namespace

std::vector<Problem> problems_of(const DesignQuestion& question) {
  std::vector<Problem> problems;
  const SceneInUnits& scene = question.scene;
  const auto demand = [&](bool holds, const std::string& field, const std::string& message) {
    if (!holds) problems.push_back({field, message});
  };
  demand(scene.exciting_force.value_or(0) == 0, "scene",
         "must be a free decay, without a force: that of --under-force is not the scene's");
  demand(scene.damper().secondary_displacement.value_or(0) == 0, "scene",
         "must release the secondary mass at the left wall, because the clearance is to be found");
  const double from = std::abs(scene.initial_displacement.value_or(0));
  if (question.has_decay) {
    demand(question.amplitude > 0 && question.amplitude < from, "amplitude",
           filled("must be > 0 and < the initial displacement, {}, got {}", from, question.amplitude));
    demand(question.time > 0, "time", filled("must be > 0, got {}", question.time));
  } else {
    demand(question.forced.has_value(), "time", "must be given, or a force");
  }
  if (question.forced) {
    const auto& [force, least, most, amplitude] = *question.forced;
    demand(force > 0, "force", filled("must be > 0, got {}", force));
    demand(least > 0 && least < most, "frequencies",
           filled("must be two numbers > 0, the first one smaller, got {} and {}", least, most));
    demand(amplitude > 0, "forced_amplitude", filled("must be > 0, got {}", amplitude));
  }
  demand(question.share >= 0.5 && question.share <= 0.999, "share",
         filled("must be >= 0.5 and <= 0.999, got {}", question.share));
  demand(question.neighbours >= 1, "neighbours", filled("must be >= 1, got {}", question.neighbours));
  if (!problems.empty()) return problems;

  const auto value_of = [&](const Variable& variable) -> DesignRange {
    if (variable.name == "secondary_mass") return question.secondary_mass;
    if (variable.name == "clearance") return question.clearance;
    const double value = variable.number_in_units.in(scene).value_or(0);
    return {value, value};
  };
  demand(!question.tolerances.empty(), "tolerance", "at least one must be given");
  for (auto each = question.tolerances.begin(); each != question.tolerances.end(); ++each) {
    const std::string& name = each->variable.name;
    const DesignRange value = value_of(each->variable);
    const auto width = [&](double about) {
      return each->relative ? each->width * std::abs(about) : each->width;
    };
    const double low = value.least - width(value.least), high = value.most + width(value.most);
    demand(
        each->variable.range.allows(low) && each->variable.range.allows(high), "tolerance",
        filled("{} must stay {}, got {} to {}", name, each->variable.range.describe("a number"), low, high));
    demand(std::none_of(question.tolerances.begin(), each,
                        [&](const SampledNumber& other) { return other.variable.name == name; }),
           "tolerance", filled("must name each number once, got {} twice", in_quotes(name)));
    demand(!(name == "damping" && scene.damping_ratio) && !(name == "damping_ratio" && scene.damping),
           "tolerance", name + " has no value in the scene to vary about");
  }
  for (const auto& [name, range] :
       {std::pair("secondary_mass", question.secondary_mass), {"clearance", question.clearance}})
    demand(range.least > 0 && (range.least < range.most ||
                               (name == std::string_view("secondary_mass") && range.least == range.most)),
           name,
           filled("must be two numbers > 0, the first one smaller, got {} and {}", range.least, range.most));
  if (!problems.empty()) return problems;
  for (const Design& corner : {Design{question.secondary_mass.least, question.clearance.least},
                               Design{question.secondary_mass.most, question.clearance.most}}) {
    const auto found = problems_of(*scene_of_design(question, corner, until_of_check(question)).in_units);
    problems.insert(problems.end(), found.begin(), found.end());
    if (!problems.empty()) return problems;
  }
  const SceneFile heaviest = scene_of_design(
      question, {question.secondary_mass.most, question.clearance.most}, until_of_check(question));
  problems = incompatibilities_of(dimensionless(*heaviest.in_units), question.engine);
  if (question.forced) {
    const Plan forced = forced_plan(question, {question.secondary_mass.most, question.clearance.most}, 1,
                                    question.seed, few_frequencies);
    for (const Problem& each : problems_of(dimensionless(*forced.scene.in_units), forced.engine))
      if (std::ranges::find(problems, each.message, &Problem::message) == problems.end())
        problems.push_back(each);
  }
  if (const auto held = problem_of_locking(question)) problems.push_back(*held);
  return problems;
}

SceneFile scene_of_design(const DesignQuestion& question, const Design& design, double time) {
  SceneFile file;
  file.in_units = question.scene;
  file.in_units->damper().secondary_mass = design.secondary_mass;
  file.in_units->damper().clearance = design.clearance;
  if (question.has_decay) file.in_units->until_millimetres = question.amplitude;
  file.in_units->until_seconds = time;
  return file;
}

Plan search_plan(const DesignQuestion& question, double time, std::vector<double> masses,
                 std::vector<double> clearances) {
  // The run must include the end of a half cycle whose peak is in time, even with the heaviest mass stuck.
  const SceneInUnits& scene = question.scene;
  const double longest_period =
      2 * std::numbers::pi * std::sqrt((*scene.mass + masses.back()) / *stiffness_of(scene));
  Plan plan;
  plan.scene = scene_of_design(question, {masses.front(), clearances.front()}, time + longest_period);
  plan.engine = question.engine;
  plan.grid = {axis_of("secondary_mass", std::move(masses)), axis_of("clearance", std::move(clearances))};
  plan.samples =
      Samples{draws_of_search(question), question.seed, SamplingMethod::random, question.tolerances};
  plan.quantities = {time_below(question.amplitude)};
  return plan;
}

Plan check_plan(const DesignQuestion& question, const Design& design) {
  Plan plan;
  plan.scene = scene_of_design(question, design, until_of_check(question));
  plan.engine = question.engine;
  plan.samples = Samples{question.neighbours, question.seed + 1, SamplingMethod::random, question.tolerances};
  plan.quantities = {time_below(question.amplitude), quantity_of("largest_impact_speed"),
                     quantity_of("largest_wall_force")};
  return plan;
}

Plan forced_plan(const DesignQuestion& question, const Design& design, std::int64_t draws, std::int64_t seed,
                 std::int64_t count) {
  Plan plan;
  plan.scene = scene_of_design(question, design, 1);  // steady motions know no stop
  SceneInUnits& scene = *plan.scene.in_units;
  scene.until_millimetres.reset();
  scene.initial_displacement = scene.initial_velocity = 0;
  scene.exciting_force = question.forced->force;
  plan.engine = question.engine;
  plan.samples = Samples{draws, seed, SamplingMethod::random, question.tolerances};
  plan.quantities = {quantity_of("worst_steady_amplitude"), quantity_of("worst_frequency")};
  plan.forced.frequencies = frequencies_of(question, design, count);
  // A free motion falls to 0.002 of itself in 1 / zeta periods.
  const double zeta = dimensionless(scene).damping_ratio;
  plan.forced.steady.tolerance = 1e-6;
  plan.forced.steady.longest_period = 4;
  plan.forced.steady.max_periods = std::int64_t(std::clamp(std::ceil(1 / zeta), 200.0, 1000.0));
  plan.forced.steady.mean_periods = 100;
  return plan;
}

Plan forced_check_plan(const DesignQuestion& question, const Design& design) {
  return forced_plan(question, design, question.neighbours, question.seed + 1, forced_check_frequencies);
}

// (M15.15).
std::optional<SteadyPeak> peak_of_viscous_damping(const DesignQuestion& question) {
  const ForcedDemand& forced = *question.forced;
  const SceneInUnits scene = *scene_of_design(question, {least_part * *question.scene.mass, 1}, 1).in_units;
  const double unit = scales_of(scene).of(Dimension::frequency);
  const double zeta = dimensionless(scene).damping_ratio;
  const double resonance = std::sqrt(std::max(0.0, 1 - 2 * zeta * zeta)) * unit;
  const double f = std::clamp(resonance, forced.least, forced.most), w2 = f / unit * (f / unit);
  const double impedance = std::sqrt((1 - w2) * (1 - w2) + 4 * zeta * zeta * w2);
  if (!(impedance > 0)) return std::nullopt;
  return SteadyPeak{1e3 * forced.force / *stiffness_of(scene) / impedance, f};
}

DesignAnswer find_designs(const DesignQuestion& question, const Threads& threads,
                          const std::function<void(const std::string& doing)>& tell) {
  require_none(problems_of(question));
  DesignAnswer answer;
  std::atomic<std::int64_t> runs = 0;
  answer.draws = draws_of_search(question);
  answer.late_allowed = late_allowed_in_search(question);
  answer.none_needed = true;
  if (question.has_decay) {
    Plan empty = check_plan(question, {least_part * *question.scene.mass, question.clearance.least});
    empty.samples.reset();
    answer.time_of_viscous_damping = made(empty, 0).numbers[0];
    answer.none_needed = answer.time_of_viscous_damping && *answer.time_of_viscous_damping <= question.time;
  }
  if (question.forced) {
    answer.peak_of_viscous_damping = peak_of_viscous_damping(question);
    answer.none_needed = answer.none_needed && answer.peak_of_viscous_damping &&
                         answer.peak_of_viscous_damping->amplitude <= question.forced->amplitude;
  }
  answer.met = answer.none_needed;
  if (answer.none_needed) return answer;

  const auto check = [&](FoundDesign& each) {
    DesignQuestion with = question;
    // What falls short of the requirement is not decided by neighbours, only described.
    if (question.forced && !answer.met) {
      with.neighbours = std::min(question.neighbours, 2 * forced_batch);
      with.most_enlarged = 1;
    }
    tell(filled("checking a secondary mass of {} with {} neighbours",
                rounded_text(each.design.secondary_mass, 3), with.neighbours));
    each.check = checked(with, each, threads);
  };
  DesignQuestion asked = question;
  for (const auto& [time, clearance] : fractions) {
    if (question.forced && (time < 1 || clearance < 1)) break;
    asked.time = time * question.time;
    asked.clearance.most =
        clearance < 1 ? rounded(clearance * question.clearance.most) : question.clearance.most;
    if (!(asked.clearance.least < asked.clearance.most)) continue;
    const auto found = DesignSearch(asked, threads, tell, runs).lightest();
    if (!found && answer.designs.empty()) break;
    const auto is_it = [&](const FoundDesign& before) { return before.design == *found; };
    if (!found || std::ranges::any_of(answer.designs, is_it)) continue;
    answer.designs.push_back(found_by(asked, *found));
    // No design for less time or clearance is lighter than the first.
    if (answer.designs.size() == 1) asked.secondary_mass.least = found->secondary_mass;
  }
  answer.met = !answer.designs.empty();
  if (!answer.met)
    if (const auto soonest = DesignSearch(question, threads, tell, runs).soonest())
      answer.designs.push_back(*soonest);
  for (FoundDesign& each : answer.designs) check(each);
  // Few draws are in a search under a force: a heavier design follows on one that the check does not confirm.
  for (int n = 0; question.forced && answer.met && !answer.designs[0].check.confirmed && n < most_heavier;
       ++n) {
    asked.secondary_mass.least = rounded(forced_steps.mass * answer.designs[0].design.secondary_mass);
    if (!(asked.secondary_mass.least < asked.secondary_mass.most)) break;
    const auto heavier = DesignSearch(asked, threads, tell, runs).lightest();
    if (!heavier) break;
    answer.designs[0] = found_by(asked, *heavier);
    check(answer.designs[0]);
  }
  answer.runs = runs;
  return answer;
}

// --- The file ---------------------------------------------------------------------------------------------

namespace {

using Layout = JsonWriter::Layout;

void write_question(JsonWriter& out, const DesignQuestion& question) {
  out.open_object("question", Layout::lines);
  out.open_object("scene", Layout::one_line);
  const Design given{*question.scene.damper().secondary_mass, *question.scene.damper().clearance};
  write_unit_fields(out, *scene_of_design(question, given, until_of_check(question)).in_units);
  out.close();
  write_engine(out, question.engine);
  const auto of_decay = [&](double number) {
    return question.has_decay ? std::optional(number) : std::nullopt;
  };
  out.fields("amplitude", of_decay(question.amplitude), "time", of_decay(question.time));
  if (const auto& forced = question.forced)
    out.object("forced", Layout::one_line, "force", forced->force, "least_frequency", forced->least,
               "most_frequency", forced->most, "amplitude", forced->amplitude);
  out.field("share", question.share);
  out.object("secondary_mass", Layout::one_line, "least", question.secondary_mass.least, "most",
             question.secondary_mass.most);
  out.object("clearance", Layout::one_line, "least", question.clearance.least, "most",
             question.clearance.most);
  out.objects("tolerances", Layout::one_line, question.tolerances, [&](const SampledNumber& each) {
    out.fields("number", each.variable.name, "half_width", each.width, "relative", each.relative);
  });
  out.fields("neighbours", question.neighbours, "seed", question.seed);
  out.close();
}

void write_design(JsonWriter& out, const FoundDesign& found, const DesignQuestion& question) {
  const DesignCheck& check = found.check;
  std::optional<double> force = check.largest_wall_force;
  if (force) force = force_in_unit(*force, question);
  const bool has_decay = question.has_decay;
  const auto amplitude_of = [](const std::optional<SteadyPeak>& peak) {
    return peak ? std::optional(peak->amplitude) : std::nullopt;
  };
  out.field("time", has_decay ? std::optional(found.time) : std::nullopt);
  if (question.forced)
    out.fields("amplitude", found.amplitude, "worst_amplitude", amplitude_of(check.worst_peak), "not_steady",
               check.not_steady, "worst_frequency",
               check.worst_peak ? std::optional(frequency_in_unit(check.worst_peak->frequency, question))
                                : std::nullopt,
               "amplitude_of_share", check.amplitude_of_share, "nominal_amplitude",
               amplitude_of(check.nominal_peak));
  out.fields("widest_clearance", found.widest, "secondary_mass", found.design.secondary_mass, "clearance",
             found.design.clearance, "nominal_time", check.nominal_time, "time_of_share", check.time_of_share,
             "slowest", check.slowest, "in_time", check.in_time, "neighbours", check.neighbours, "share_low",
             check.share.low, "share_high", check.share.high, "confirmed", check.confirmed,
             "largest_impact_speed", has_decay ? std::optional(check.largest_impact_speed) : std::nullopt,
             "largest_wall_force", force);
}

}  // namespace

double force_in_unit(double force, const DesignQuestion& question) {
  return question.in_units ? force : force * (1 / scales_of(question.scene).of(Dimension::force));
}
double frequency_in_unit(double frequency, const DesignQuestion& question) {
  return question.in_units ? frequency : frequency / scales_of(question.scene).of(Dimension::frequency);
}

std::string design_text(const DesignQuestion& question, const DesignAnswer& answer) {
  JsonWriter out("design");
  out.open_object(Layout::lines);
  out.field("schema", "impact-damper/design/1");
  write_question(out, question);
  out.open_object("units", Layout::one_line);
  using enum Dimension;
  for (const Dimension each : {mass, length, time, velocity, force})
    out.field(name_of(each), unit_of(each, question.in_units));
  if (question.forced) out.field(name_of(frequency), unit_of(frequency, question.in_units));
  out.close();
  out.object("search", Layout::one_line, "draws", answer.draws, "late_allowed", answer.late_allowed, "runs",
             answer.runs);
  if (question.forced) {
    const auto& peak = answer.peak_of_viscous_damping;
    out.object("alone", Layout::one_line, "amplitude", peak ? std::optional(peak->amplitude) : std::nullopt,
               "frequency",
               peak ? std::optional(frequency_in_unit(peak->frequency, question)) : std::nullopt);
  }
  if (answer.none_needed) out.field("none_needed", true);
  out.field("met", answer.met);
  out.objects("designs", Layout::lines, answer.designs,
              [&](const FoundDesign& each) { write_design(out, each, question); });
  write_provenance(out);
  return sealed(out.finish());
}

}  // namespace impact_damper
