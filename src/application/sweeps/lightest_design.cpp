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

constexpr double coarse_mass_step = 1.1, mass_step = 1.01, clearance_step = 1.05;
// Late draws to be expected if exactly the required share were in time; this decides how many are drawn.
constexpr double late_draws = 20;
// Fractions of the time and of the widest clearance for which designs are searched.
constexpr std::array<std::pair<double, double>, 5> fractions{
    {{1, 1}, {1, 0.5}, {1, 0.25}, {0.8, 1}, {0.6, 1}}};
constexpr double least_part = 1e-9;  // of the primary mass: a secondary mass without effect
constexpr double time_step = 1.05;   // ratio of successive times tried where no design is in time

std::int64_t draws_of_search(double share) {
  return std::int64_t(std::floor(late_draws / (1 - share) + 0.5));
}

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

class DesignSearch {
 public:
  DesignSearch(const DesignQuestion& question, const Threads& threads,
               const std::function<void(const std::string&)>& tell, std::atomic<std::int64_t>& runs)
      : question_(question), threads_(threads), tell_(tell), runs_(runs) {}

  // Returns the lightest design in time, absent if there is none. The masses tried ascend in coarse steps,
  // then in fine ones from the last coarse mass that was late.
  std::optional<Design> lightest() {
    const double time = question_.time;
    const std::vector<double> coarse = steps_between(question_.secondary_mass, coarse_mass_step);
    const auto found = first_of(coarse, time);
    if (!found || found->mass == 0) return design_of(coarse, found);
    std::vector<double> fine = steps_between({coarse[found->mass - 1], coarse[found->mass]}, mass_step);
    fine.erase(fine.begin());
    fine.pop_back();
    const auto lighter = fine.empty() ? std::nullopt : first_of(fine, time);
    return lighter ? design_of(fine, lighter) : design_of(coarse, found);
  }

  // Returns the heaviest mass with the shortest of the times time * time_step^n that it keeps.
  std::optional<FoundDesign> soonest() {
    double time = question_.time;
    while (time <= longest_followed * question_.time) {
      const std::vector<double> heaviest{question_.secondary_mass.most};
      if (const auto found = design_of(heaviest, first_of(heaviest, time)))
        return FoundDesign{time, question_.clearance.most, *found, {}};
      time *= time_step;
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
  // The draws of one design so far. They end with the one that is one too many late.
  struct Drawn {
    std::vector<double> times;
    std::int64_t late = 0;
    double mean = 0;  // of the first first_draws_ times
  };

  // Returns the lightest of ascending masses for which a clearance is in time, with its soonest clearance
  // (M15.10).
  std::optional<Place> first_of(const std::vector<double>& masses, double time) {
    const Plan plan = search_plan(question_, time, masses, clearances_);
    for (std::size_t m = 0; m < masses.size(); ++m) {
      tell_(filled("searched for {} with a secondary mass of {}, {} runs so far", rounded_text(time, 3),
                   rounded_text(masses[m], 3), runs_.load()));
      if (const auto best = soonest_of(plan, m * clearances_.size(), time)) return Place{m, *best};
    }
    return std::nullopt;
  }

  // Returns the clearance with the least time_of_most() among those in time, absent if there is none. Their
  // candidates begin at `first`. A few draws of each show which is likely the soonest; its time then ends the
  // draws of slower ones early.
  std::optional<std::size_t> soonest_of(const Plan& plan, std::size_t first, double time) {
    std::vector<Drawn> drawn(clearances_.size());
    const auto draw = [&](std::size_t c, std::int64_t draws, double latest) {
      draw_more(plan, std::int64_t(first + c), draws, latest, drawn[c]);
    };
    const auto is_late = [&](const Drawn& each) { return each.late > late_allowed_; };
    for_each_index(std::ssize(drawn), threads_, [&](std::int64_t c) {
      Drawn& each = drawn[std::size_t(c)];
      draw(std::size_t(c), first_draws_, time);
      each.mean = std::accumulate(each.times.begin(), each.times.end(), 0.0) / double(each.times.size());
    });
    const auto likely = std::ranges::min_element(drawn, {}, [&](const Drawn& each) {
      return is_late(each) ? std::numeric_limits<double>::infinity() : each.mean;
    });
    if (is_late(*likely)) return std::nullopt;
    draw(std::size_t(likely - drawn.begin()), draws_, time);
    const double latest = is_late(*likely) ? time : time_of_most(*likely);
    for_each_index(std::ssize(drawn), threads_, [&](std::int64_t c) {
      if (!is_late(drawn[std::size_t(c)])) draw(std::size_t(c), draws_, latest);
    });
    std::optional<std::size_t> best;
    for (std::size_t c = 0; c < drawn.size(); ++c)
      if (!is_late(drawn[c]) && !(best && time_of_most(drawn[*best]) <= time_of_most(drawn[c]))) best = c;
    return best;
  }

  // Draws until there are `draws` in all, or until too many of them are later than `latest`.
  void draw_more(const Plan& plan, std::int64_t candidate, std::int64_t draws, double latest, Drawn& drawn) {
    drawn.late = std::ranges::count_if(drawn.times, [&](double taken) { return taken > latest; });
    const std::int64_t before = std::ssize(drawn.times);
    while (std::ssize(drawn.times) < draws && drawn.late <= late_allowed_) {
      const auto taken = made(plan, candidate * draws_ + std::ssize(drawn.times)).numbers[0];
      drawn.times.push_back(taken.value_or(std::numeric_limits<double>::max()));
      drawn.late += drawn.times.back() > latest ? 1 : 0;
    }
    runs_ += std::ssize(drawn.times) - before;
  }

  // Returns the time by which all draws except those that may be late are below the amplitude.
  double time_of_most(Drawn& drawn) const {
    const auto most = drawn.times.end() - 1 - late_allowed_;
    std::ranges::nth_element(drawn.times, most);
    return *most;
  }

  const DesignQuestion& question_;
  const Threads& threads_;
  const std::function<void(const std::string&)>& tell_;
  std::atomic<std::int64_t>& runs_;
  const std::vector<double> clearances_ = steps_between(question_.clearance, clearance_step);
  const std::int64_t draws_ = draws_of_search(question_.share), first_draws_ = draws_ / 20,
                     late_allowed_ = late_allowed_of(draws_, question_.share);
};

DesignCheck checked(const DesignQuestion& question, const FoundDesign& found, const Threads& threads) {
  const Plan plan = check_plan(question, found.design);
  Plan alone = plan;
  alone.samples.reset();
  DesignCheck check;
  check.nominal_time = made(alone, 0).numbers[0];

  const std::int64_t count = runs_of(plan);
  std::vector<KeptNumbers> neighbours(static_cast<std::size_t>(count));
  for_each_index(count, threads, [&](std::int64_t i) { neighbours[std::size_t(i)] = made(plan, i); });
  std::vector<double> times;
  for (const KeptNumbers& each : neighbours) {
    const auto& [time, speed, force] = std::tie(each.numbers[0], each.numbers[1], each.numbers[2]);
    times.push_back(time.value_or(std::numeric_limits<double>::infinity()));
    check.in_time += time && *time <= found.time ? 1 : 0;
    check.largest_impact_speed = std::max(check.largest_impact_speed, speed.value_or(0));
    if (force) check.largest_wall_force = std::max(check.largest_wall_force.value_or(0), *force);
  }
  check.share = interval_of_share(check.in_time, count);
  check.confirmed = check.share.low >= question.share;
  check.rejected = check.share.high < question.share;
  std::ranges::sort(times);
  const auto within = [&](std::int64_t n) {
    const double time = times[std::size_t(n - 1)];
    return std::isfinite(time) ? std::optional(time) : std::nullopt;
  };
  check.slowest = within(count);
  check.time_of_share = within(std::int64_t(std::ceil(question.share * double(count))));
  return check;
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
    const double most = rounded(below * (question.amplitude / held * (mass + masses.least) - mass));
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
  const double asked = question.amplitude;
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
  return Problem{"amplitude",
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
  demand(scene.exciting_force.value_or(0) == 0, "scene", "must be a free decay, without a force");
  demand(scene.damper().secondary_displacement.value_or(0) == 0, "scene",
         "must release the secondary mass at the left wall, because the clearance is to be found");
  const double from = std::abs(scene.initial_displacement.value_or(0));
  demand(question.amplitude > 0 && question.amplitude < from, "amplitude",
         filled("must be > 0 and < the initial displacement, {}, got {}", from, question.amplitude));
  demand(question.time > 0, "time", filled("must be > 0, got {}", question.time));
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
    demand(range.least > 0 && range.least < range.most, name,
           filled("must be two numbers > 0, the first one smaller, got {} and {}", range.least, range.most));
  if (!problems.empty()) return problems;
  for (const Design& corner : {Design{question.secondary_mass.least, question.clearance.least},
                               Design{question.secondary_mass.most, question.clearance.most}}) {
    const auto found =
        problems_of(*scene_of_design(question, corner, longest_followed * question.time).in_units);
    problems.insert(problems.end(), found.begin(), found.end());
    if (!problems.empty()) return problems;
  }
  const SceneFile heaviest =
      scene_of_design(question, {question.secondary_mass.most, question.clearance.most}, question.time);
  problems = incompatibilities_of(dimensionless(*heaviest.in_units), question.engine);
  if (const auto held = problem_of_locking(question)) problems.push_back(*held);
  return problems;
}

SceneFile scene_of_design(const DesignQuestion& question, const Design& design, double time) {
  SceneFile file;
  file.in_units = question.scene;
  file.in_units->damper().secondary_mass = design.secondary_mass;
  file.in_units->damper().clearance = design.clearance;
  file.in_units->until_millimetres = question.amplitude;
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
      Samples{draws_of_search(question.share), question.seed, SamplingMethod::random, question.tolerances};
  plan.quantities = {time_below(question.amplitude)};
  return plan;
}

Plan check_plan(const DesignQuestion& question, const Design& design) {
  Plan plan;
  plan.scene = scene_of_design(question, design, longest_followed * question.time);
  plan.engine = question.engine;
  plan.samples = Samples{question.neighbours, question.seed + 1, SamplingMethod::random, question.tolerances};
  plan.quantities = {time_below(question.amplitude), quantity_of("largest_impact_speed"),
                     quantity_of("largest_wall_force")};
  return plan;
}

DesignAnswer find_designs(const DesignQuestion& question, const Threads& threads,
                          const std::function<void(const std::string& doing)>& tell) {
  require_none(problems_of(question));
  DesignAnswer answer;
  std::atomic<std::int64_t> runs = 0;
  DesignQuestion asked = question;
  for (const auto& [time, clearance] : fractions) {
    asked.time = time * question.time;
    asked.clearance.most =
        clearance < 1 ? rounded(clearance * question.clearance.most) : question.clearance.most;
    if (!(asked.clearance.least < asked.clearance.most)) continue;
    const auto found = DesignSearch(asked, threads, tell, runs).lightest();
    if (!found && answer.designs.empty()) break;
    const auto is_it = [&](const FoundDesign& before) { return before.design == *found; };
    if (!found || std::ranges::any_of(answer.designs, is_it)) continue;
    answer.designs.push_back({asked.time, asked.clearance.most, *found, {}});
    // No design for less time or clearance is lighter than the first.
    if (answer.designs.size() == 1) asked.secondary_mass.least = found->secondary_mass;
  }
  answer.met = !answer.designs.empty();
  if (!answer.met)
    if (const auto soonest = DesignSearch(question, threads, tell, runs).soonest())
      answer.designs.push_back(*soonest);
  for (FoundDesign& each : answer.designs) {
    tell(filled("checking the design for {} with {} neighbours", rounded_text(each.time, 3),
                question.neighbours));
    each.check = checked(question, each, threads);
  }
  Plan empty = check_plan(question, {least_part * *question.scene.mass, question.clearance.least});
  empty.samples.reset();
  answer.time_of_viscous_damping = made(empty, 0).numbers[0];
  answer.draws = draws_of_search(question.share);
  answer.late_allowed = late_allowed_of(answer.draws, question.share);
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
  write_unit_fields(out, *scene_of_design(question, given, longest_followed * question.time).in_units);
  out.close();
  write_engine(out, question.engine);
  out.fields("amplitude", question.amplitude, "time", question.time, "share", question.share);
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
  out.fields("time", found.time, "widest_clearance", found.widest, "secondary_mass",
             found.design.secondary_mass, "clearance", found.design.clearance, "nominal_time",
             check.nominal_time, "time_of_share", check.time_of_share, "slowest", check.slowest, "in_time",
             check.in_time, "share_low", check.share.low, "share_high", check.share.high, "confirmed",
             check.confirmed, "largest_impact_speed", check.largest_impact_speed, "largest_wall_force",
             force);
}

}  // namespace

double force_in_unit(double force, const DesignQuestion& question) {
  return question.in_units ? force : force * (1 / scales_of(question.scene).of(Dimension::force));
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
  out.close();
  out.object("search", Layout::one_line, "draws", answer.draws, "late_allowed", answer.late_allowed, "runs",
             answer.runs);
  out.field("met", answer.met);
  out.objects("designs", Layout::lines, answer.designs,
              [&](const FoundDesign& each) { write_design(out, each, question); });
  write_provenance(out);
  return sealed(out.finish());
}

}  // namespace impact_damper
