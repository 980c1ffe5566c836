// What is recorded, and when a run ends, changes nothing of the motion: properties of all three engines over
// random scenes and scenes of round numbers.
#include <doctest/doctest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <limits>
#include <string>
#include <vector>

#include "engines/observed.hpp"
#include "impact_damper/engines/cem_scheme.hpp"
#include "impact_damper/io/scene_file.hpp"
#include "impact_damper/simulate.hpp"
#include "same_run.hpp"
#include "shared_scenes.hpp"

using namespace impact_damper;
using random_scenes::scene_of;
using reference::absent, reference::Columns, reference::columns_of;

namespace {

bool same_bits(double a, double b) {
  return std::bit_cast<std::uint64_t>(a) == std::bit_cast<std::uint64_t>(b);
}

// A scene, an engine's options, and what else the tests of it choose at random.
struct Trial {
  Scene scene;
  Engine engine;
  reference::Random random;
  std::string text;
};

// The component element method in steps so large that it is quick, in each of its ways.
Cem cem_of(const Scene& scene, bool round, reference::Random& random) {
  Cem options{.damper = random.chance(0.5) ? Damper::centred : Damper::lagged,
              .locate = random.chance(0.5),
              .calibration = random.chance(0.5) ? Calibration::fixed_wall : Calibration::two_body,
              .max_steps = 10'000};
  double h = stability_limit(scene, options.damper, options.calibration) / random.uniform(2, 30);
  double large = 0.1;
  if (scene.force_amplitude != 0) {
    h = std::min(h, std::numbers::pi / scene.force_frequency / random.uniform(10, 100));
    large = std::min(large, 3 / scene.force_frequency);
  }
  // A round step with round scenes: samples and ends then coincide with steps, but for rounding.
  options.time_step = round ? std::pow(10, std::floor(std::log10(h))) : h;
  if (random.chance(0.5) && large > 2 * h) options.large_step = large;
  if (random.chance(0.5)) options.stuck_speed = random.uniform(0.01, 1);
  return options;
}

template <class Choice>
Trial trial_of(std::uint64_t seed, bool round) {
  Trial trial{round ? round_scenes::scene_of(seed) : random_scenes::scene_of(seed),
              Choice{},
              reference::Random(seed + 1'000'000'007),
              {}};
  Scene& scene = trial.scene;
  if constexpr (std::is_same_v<Choice, Restitution>)
    scene.damper().y0 = std::clamp(scene.damper().y0, 0.0, 1.0);
  if constexpr (std::is_same_v<Choice, Cem>) {
    // Walls as stiff as an impact between the masses can be in ten thousand steps that go somewhere.
    scene.damper().mass_ratio = std::max(scene.damper().mass_ratio, 1e-3);
    scene.damper().wall_stiffness = std::min(scene.damper().wall_stiffness, 1e5 * scene.damper().mass_ratio);
    trial.engine = cem_of(scene, round, trial.random);
  }
  if (trial.random.chance(0.3)) scene.until_amplitude = std::fabs(scene.x0) * trial.random.uniform(0.01, 1);
  if (scene.until_amplitude == 0) scene.until_amplitude.reset();
  std::visit([](auto& options) { options.budget.max_impacts = 1000; }, trial.engine);
  trial.text = std::string(name_of(trial.engine)) + (round ? ", round scene " : ", random scene ") +
               std::to_string(seed) + ": " + scene_text(scene);
  if (scene.until_amplitude) trial.text += ", until_amplitude " + std::to_string(*scene.until_amplitude);
  return trial;
}

int compared_rows = 0;
constexpr std::uint64_t first_seed = 1, seeds = 250;

// `property` of a trial, told as text where it does not hold, for so many random and round scenes.
template <class Choice, class Property>
void holds_for(Property&& property) {
  for (const bool round : {false, true})
    for (std::uint64_t seed = first_seed; seed < first_seed + seeds; ++seed) {
      Trial trial = trial_of<Choice>(seed, round);
      const std::string failure = property(trial);
      if (!failure.empty()) FAIL_CHECK(trial.text << "\n" << failure);
    }
}

Record everything(const Scene& scene) { return reference::everything({{0, *scene.until_time, 51}}); }

std::string row_text(const std::string& name, std::size_t row, double a, double b) {
  char text[200];
  std::snprintf(text, sizeof text, "%s[%zu]: %.17g and %.17g", name.c_str(), row, a, b);
  return text;
}

// What differs between what both runs record, or nothing.
std::string difference(const Run& part, const Run& whole) {
  if (part.stop_reason != whole.stop_reason || !same_bits(part.end_time, whole.end_time))
    return row_text("end_time", 0, part.end_time, whole.end_time);
  const Columns all = columns_of(whole);
  for (const auto& [name, column] : columns_of(part)) {
    const std::vector<double>& other = all.at(name);
    if (column.size() != other.size())
      return row_text(name + ".size()", 0, double(column.size()), double(other.size()));
    for (std::size_t i = 0; i < column.size(); ++i)
      if (!same_bits(column[i], other[i])) return row_text(name, i, column[i], other[i]);
  }
  return {};
}

std::string subsets_agree(Trial& trial) {
  const Record all = everything(trial.scene);
  const Run whole = simulate(trial.scene, trial.engine, all);
  for (int i = 0; i < 8; ++i) {
    // Nothing but one, then any.
    const std::uint64_t kept = i < 5 ? 1u << i : trial.random.bits() % 32;
    Record some{.half_cycles = (kept & 1) != 0,
                .impacts = (kept & 2) != 0,
                .contacts = (kept & 4) != 0,
                .energy = (kept & 8) != 0};
    if (kept & 16) some.history = all.history;
    std::string found = difference(simulate(trial.scene, trial.engine, some), whole);
    if (!found.empty()) return "recording " + std::to_string(kept) + ": " + found;
  }
  // Samples at other times, or begun by an amplitude.
  Record other = all;
  other.history.clear();
  if (trial.scene.x0 != 0 && trial.random.chance(0.5)) {
    other.history_below = {{std::fabs(trial.scene.x0) * 1.001, *trial.scene.until_time / 3, 17}};
  } else {
    other.history = {{trial.random.uniform(0, 1), *trial.scene.until_time * 0.9, 23}};
  }
  Run sampled = simulate(trial.scene, trial.engine, other);
  sampled.history.reset();
  std::string found = difference(sampled, whole);
  return found.empty() ? found : "sampling otherwise: " + found;
}

// Where `cut`, which ends earlier, is not the beginning of `whole`, or nothing.
std::string no_beginning(const Run& cut, const Run& whole) {
  const Columns all = columns_of(whole), begun = columns_of(cut);
  const double end = cut.end_time;
  // A contact that the end cuts, and its loss, are not yet what they are in the longer run.
  const bool in_contact = !cut.contacts->end.empty() && cut.contacts->end.back() == end;
  for (const auto& [name, column] : begun) {
    if (name.starts_with("energy.") && !name.starts_with("energy.initial") && name != "energy.impact_loss")
      continue;
    const std::vector<double>& other = all.at(name);
    if (column.size() > other.size())
      return row_text(name + ".size()", 0, double(column.size()), double(other.size()));
    for (std::size_t i = 0; i < column.size(); ++i) {
      const bool last = i + 1 == column.size();
      if (in_contact && last && (name == "contacts.end" || name == "energy.impact_loss")) continue;
      if ((name == "impacts.phase_deg" || name == "impacts.amplitude") && column[i] == absent) continue;
      if (!same_bits(column[i], other[i])) return row_text(name, i, column[i], other[i]);
    }
  }
  // Nothing before the end is left out, nothing after it is told.
  for (const char* times : {"half_cycles.zero_crossing", "impacts.time", "contacts.begin", "history.time"}) {
    const std::vector<double>& told = begun.at(times);
    const std::size_t rows = told.size();
    if (rows > 0 && told.back() > end)
      return row_text(std::string(times) + " after the end", rows - 1, told.back(), end);
    if (rows < all.at(times).size() && all.at(times)[rows] < end)
      return row_text(std::string(times) + " is left out", rows, all.at(times)[rows], end);
  }
  return {};
}

std::string cuts_are_beginnings(Trial& trial) {
  const Record record = everything(trial.scene);
  const Run whole = simulate(trial.scene, trial.engine, record);
  const auto any = [&](const std::vector<double>& values) {
    return values.empty() ? 0.0 : values[trial.random.bits() % values.size()];
  };
  const auto compared = [&](const std::string& by, const Scene& scene, const Engine& engine) {
    const std::string found = no_beginning(simulate(scene, engine, record), whole);
    return found.empty() ? found : "cut by " + by + ": " + found;
  };
  // At any time, and on the dot of events and samples.
  for (const double time :
       {trial.random.uniform(0, whole.end_time), trial.random.uniform(0, whole.end_time),
        any(whole.impacts->time), any(whole.contacts->end), any(whole.half_cycles->zero_crossing),
        any(whole.half_cycles->peak_time), any(whole.history->time)}) {
    if (!(time > 0)) continue;
    Scene earlier = trial.scene;
    earlier.until_time = time;
    const std::string found =
        compared("until_time " + row_text("", 0, time, whole.end_time), earlier, trial.engine);
    if (!found.empty()) return found;
  }
  if (const double amplitude = any(whole.half_cycles->amplitude); amplitude > 0) {
    Scene earlier = trial.scene;
    earlier.until_amplitude = std::max(amplitude * (1 + 1e-15), trial.scene.until_amplitude.value_or(0));
    const std::string found = compared("until_amplitude", earlier, trial.engine);
    if (!found.empty()) return found;
  }
  const auto budgeted = [&](const std::string& by, auto&& change) {
    Engine smaller = trial.engine;
    std::visit(change, smaller);
    return compared(by, trial.scene, smaller);
  };
  const std::size_t impacts = whole.impacts->time.size(), rows = whole.half_cycles->amplitude.size();
  const auto some = [&](std::size_t most) { return std::int64_t(trial.random.bits() % (most + 1)); };
  const std::int64_t fewer_impacts = some(impacts), fewer_rows = 1 + some(rows), fewer_steps = 1 + some(9999);
  std::string found =
      budgeted("max_impacts", [&](auto& options) { options.budget.max_impacts = fewer_impacts; });
  if (found.empty())
    found = budgeted("max_half_cycles", [&](auto& options) { options.budget.max_half_cycles = fewer_rows; });
  if (found.empty())
    found = budgeted("max_time", [&](auto& options) { options.budget.max_time = whole.end_time * 0.7; });
  if (found.empty()) found = budgeted("max_steps", [&](auto& options) { options.max_steps = fewer_steps; });
  return found;
}

// What a mirrored run says of the motion itself.
Run mirrored_back(Run run) {
  for (Wall& wall : run.impacts->wall) wall = wall == Wall::left ? Wall::right : Wall::left;
  for (Wall& wall : run.contacts->wall) wall = wall == Wall::left ? Wall::right : Wall::left;
  History::Damper& its = run.history->dampers[0];
  for (auto* column : {&run.impacts->relative_velocity, &run.impacts->displacement, &run.history->x,
                       &run.history->v, &its.w})
    for (double& value : *column) value = 0 - value;  // without a negative zero
  for (double& y : its.y) y = 1 - y;
  return run;
}

// The closed-form engines count y from the wall that was met last, at the release from the nearer one: so a
// mirrored run has the same bits, but for y itself, which is nearer to 0 in one of them and has more digits
// there. Released in the middle y counts from the left wall in both: then rounding differs.
std::string mirrors(Trial& trial) {
  trial.scene.damper().y0 = std::round(trial.scene.damper().y0 * 0x1p20) / 0x1p20;  // so that 1 - y0 is exact
  if (trial.scene.damper().y0 == 0.5) return {};
  const Record record = everything(trial.scene);
  Run run = simulate(trial.scene, trial.engine, record);
  Run back = mirrored_back(simulate(mirrored(trial.scene), trial.engine, record));
  for (std::size_t i = 0; i < std::min(run.history->dampers[0].y.size(), back.history->dampers[0].y.size());
       ++i) {
    const double y = run.history->dampers[0].y[i];
    if (!(std::fabs(y - back.history->dampers[0].y[i]) <= 0x1p-52 * std::max(1.0, std::fabs(y))))
      return row_text("history.y", i, y, back.history->dampers[0].y[i]);
    back.history->dampers[0].y[i] = y;
  }
  run = mirrored_back(mirrored_back(run));
  run.history->dampers[0].y = back.history->dampers[0].y;
  return difference(back, run);
}

template <class Real>
Run stepped(const Trial& trial, const Scene& scene) {
  TestObserver<Real> recorder(everything(scene));
  const Outcome end = observed(scene, trial.engine, recorder);
  Run run{.stop_reason = end.stop_reason, .end_time = end.end_time};
  recorder.finish(run);
  return run;
}

// The component element method counts y from the left wall in flight. Near the right one y has fewer digits,
// and what is decided by them, a bounce too low for instance, follows. But rounding is all that differs: in
// extended precision, of 2^-11 the rounding, the mirrored run is nearer to the run than what double precision
// makes of either. Compared up to where that comes to 1e-7 of anything: motions that have parted may differ
// in one number less than in another.
std::string mirrors_but_for_rounding(Trial& trial) {
  trial.scene.damper().y0 = std::round(trial.scene.damper().y0 * 0x1p20) / 0x1p20;
  const Scene &scene = trial.scene, opposite = mirrored(scene);
  const Columns run = columns_of(stepped<long double>(trial, scene)),
                rounded = columns_of(stepped<double>(trial, scene)),
                back = columns_of(mirrored_back(stepped<long double>(trial, opposite))),
                rounded_back = columns_of(mirrored_back(stepped<double>(trial, opposite)));
  struct Compared {
    std::string name, times;
    double scale;
  };
  const auto largest = [&](const char* name) {
    double most = 0;
    for (double value : run.at(name)) most = std::max(most, std::fabs(value));
    return most;
  };
  const std::vector<Compared> all{{"history.x", "history.time", largest("history.x")},
                                  {"history.y", "history.time", 1},
                                  {"history.w", "history.time", largest("history.w")},
                                  {"impacts.time", "impacts.time", 1},
                                  {"contacts.end", "contacts.end", 1}};
  const auto rounding = [&](const std::string& name, std::size_t i) {
    const std::vector<double>&a = rounded.at(name), &b = rounded_back.at(name);
    const double exact = run.at(name)[i];
    return i < std::min(a.size(), b.size()) ? std::max(std::fabs(a[i] - exact), std::fabs(b[i] - exact))
                                            : absent;
  };
  double parted = absent;  // when
  for (const auto& [name, times, scale] : all)
    for (std::size_t i = 0; i < run.at(name).size(); ++i)
      if (rounding(name, i) > 1e-7 * scale) parted = std::min(parted, run.at(times)[i]);
  for (const auto& [name, times, scale] : all) {
    double most = 0x1p-48 * std::max(scale, 1.0);  // of what has come until now
    for (std::size_t i = 0; i < run.at(name).size() && run.at(times)[i] < parted; ++i) {
      most = std::max(most, rounding(name, i));
      const double value = run.at(name)[i], other = i < back.at(name).size() ? back.at(name)[i] : absent;
      if (!(std::fabs(value - other) <= most)) return row_text(name, i, value, other);
      ++compared_rows;
    }
  }
  return {};
}

// Wants what is set, and counts what it is told.
struct Selective : TestObserver<double> {
  explicit Selective(int wants)
      : half_cycles((wants & 1) != 0), contacts((wants & 2) != 0), energy((wants & 4) != 0) {}
  bool half_cycles, contacts, energy;
  int told_half_cycles = 0, told_contacts = 0, told_energy = 0;

  bool wants_half_cycles() const override { return half_cycles; }
  bool wants_contacts() const override { return contacts; }
  bool wants_energy() const override { return energy; }
  void half_cycle(double, double, double, double) override { ++told_half_cycles; }
  void contact(double, double, Wall) override { ++told_contacts; }
  EnergyBalance& energy_balance() override {
    ++told_energy;
    return TestObserver::energy_balance();
  }
};

}  // namespace

TEST_CASE_TEMPLATE("an observer is told only what it wants, also where an amplitude ends the run", Choice,
                   Exact, Restitution, Cem) {
  const Scene scene{.until_time = 100, .until_amplitude = 5.9};
  Selective all(7);
  const Outcome end = observed(scene, Choice{}, all);
  CHECK(end.stop_reason == StopReason::amplitude);
  for (int wants = 0; wants < 8; ++wants) {
    Selective some(wants);
    CAPTURE(wants);
    CHECK(observed(scene, Choice{}, some).end_time == end.end_time);
    CHECK((some.told_half_cycles > 0) == some.half_cycles);
    CHECK((some.told_contacts > 0) == some.contacts);
    CHECK((some.told_energy > 0) == some.energy);
  }
}

TEST_CASE_TEMPLATE("any subset of what can be recorded gives the same columns", Choice, Exact, Restitution,
                   Cem) {
  holds_for<Choice>(subsets_agree);
}

TEST_CASE_TEMPLATE("a run that ends earlier is the beginning of a longer one", Choice, Exact, Restitution,
                   Cem) {
  holds_for<Choice>(cuts_are_beginnings);
}

TEST_CASE_TEMPLATE("the mirrored scene gives the mirrored run in the closed-form engines, bit for bit",
                   Choice, Exact, Restitution) {
  holds_for<Choice>(mirrors);
}

TEST_CASE("the mirrored scene gives the mirrored run in the component element method, but for rounding") {
  holds_for<Cem>(mirrors_but_for_rounding);
  CHECK(compared_rows > 60'000);  // else chaos left next to nothing to compare
}

TEST_CASE("how often samples are looked at does not count against the component element method's limit") {
  // A mass so light that nothing else moves, and so fast that it meets a wall in every third step: ten
  // million events later the method gives up.
  constexpr double h = 0x1p-20;
  const Scene scene{.x0 = 0,
                    .until_time = 1000,
                    .dampers = {{.mass_ratio = 0x1p-29,
                                 .restitution = 1,
                                 .wall_stiffness = 0x1p-29 / (h * h),
                                 .y0 = 0.5,
                                 .w0 = -4 / h}}};
  const Cem options{.time_step = h, .budget = {.max_impacts = 1'000'000'000}};
  const Run run = simulate(scene, options, {}),
            sampled = simulate(scene, options, {.half_cycles = false, .history = {{0, 10, 100'000}}});
  CHECK(run.stop_reason == StopReason::step_budget);
  CHECK(run.end_time < double(options.max_steps) * h / 2);
  CHECK(sampled.stop_reason == StopReason::step_budget);
  CHECK(sampled.end_time == run.end_time);
}

TEST_CASE(
    "a mass at rest at a wall that only its third derivative presses to it is in contact, by no impact") {
  // y'' = x + 2 zeta x' - f is zero to rounding, y''' = x' - f' leads into the left wall.
  std::vector<Scene> scenes{{.x0 = 0, .force_amplitude = 1},
                            {.damping_ratio = 0.3, .x0 = 0.6, .v0 = -1, .force_amplitude = 0.5}};
  for (const double zeta : {0.0, 0.5, 0.3, 0.7, std::sqrt(0.5)})
    scenes.push_back({.damping_ratio = zeta, .x0 = 2 * zeta, .v0 = -1});
  const Record record{.impacts = true, .contacts = true};
  for (Scene scene : scenes) {
    scene.until_time = 0.5;
    CAPTURE(scene_text(scene));
    for (const Scene& start : {scene, mirrored(scene)})
      for (bool locate : {false, true}) {
        const Run run = simulate(start, Cem{.locate = locate}, record);
        CHECK(run.impacts->time.empty());
        REQUIRE(run.contacts->end.size() == 1);
        CHECK(run.contacts->begin[0] == 0);
        CHECK(run.contacts->end[0] == 0.5);
        // At the other wall the same motion leaves it, without touching it.
        Scene leaving = start;
        leaving.damper().y0 = 1 - start.damper().y0;
        leaving.until_time = 0.1;
        const Run left = simulate(leaving, Cem{.locate = locate}, record);
        CHECK(left.impacts->time.empty());
        CHECK(left.contacts->begin.empty());
      }
  }
}

// --- Any scene ---------------------------------------------------------------------------------------------

namespace {

bool finite(const std::vector<double>& values) {
  return std::ranges::all_of(values, [](double value) { return std::isfinite(value); });
}

constexpr std::uint64_t any_seeds = 2000;
constexpr double closed = 1e-10;  // 1e4 impacts at most, each a few dozen roundings

// Everything that any scene promises: finite numbers, times in order, an energy balance that closes.
void check(const Scene& scene, const Engine& engine) {
  const Run run = simulate(scene, engine, everything(scene));
  CHECK(std::isfinite(run.end_time));
  CHECK(run.end_time <= *scene.until_time);
  CHECK((run.stop_reason == StopReason::time || run.stop_reason == StopReason::impact_budget));
  const HalfCycles& rows = *run.half_cycles;
  const History& history = *run.history;
  for (const auto* column : {&rows.zero_crossing, &rows.peak_time, &rows.amplitude, &run.impacts->time,
                             &run.impacts->relative_velocity, &run.energy->impact_loss, &history.x,
                             &history.v, &history.dampers[0].y, &history.dampers[0].w})
    CHECK(finite(*column));
  for (std::size_t i = 0; i < run.impacts->time.size(); ++i) {
    const double before = i > 0 ? run.impacts->time[i - 1] : 0;
    CHECK(run.impacts->time[i] >= before);
    const double w = run.impacts->relative_velocity[i];
    CHECK((run.impacts->wall[i] == Wall::left ? w <= 0 : w >= 0));
    CHECK(run.energy->impact_loss[i] >= 0);
  }
  for (std::size_t i = 0; i < run.contacts->begin.size(); ++i)
    CHECK(run.contacts->end[i] >= run.contacts->begin[i]);
  for (std::size_t i = 1; i < rows.zero_crossing.size(); ++i) {
    CHECK(rows.zero_crossing[i] > rows.zero_crossing[i - 1]);
    CHECK(rows.amplitude[i] >= 0);
  }
  CHECK(std::abs(run.energy->residual) < closed);
}

}  // namespace

TEST_CASE(
    "any scene runs to its end in the exact engine, finite, in order and with an energy balance that "
    "closes") {
  const Exact options{.budget = {.max_impacts = 10000}};
  for (std::uint64_t seed = first_seed; seed < first_seed + any_seeds; ++seed) {
    const Scene scene = scene_of(seed);
    INFO("seed ", seed, ", scene ", scene_text(scene));
    check(scene, options);
  }
}

// x is a rounding error of what the wall makes of it: whether it rises or falls cannot be told for a while.
TEST_CASE("a scene whose primary mass has hardly moved when it is struck is no effort") {
  const Exact options{.budget = {.max_impacts = 1000}};
  for (const std::uint64_t seed : {27136u, 40313u, 99905u, 120138u, 131791u}) {
    Scene scene = scene_of(seed);
    REQUIRE(scene.x0 == 0);
    CAPTURE(scene_text(scene));
    check(scene, options);
  }
}

TEST_CASE("any scene that begins between rigid walls runs to its end in the restitution engine") {
  const Restitution options{.budget = {.max_impacts = 10000}};
  for (std::uint64_t seed = first_seed; seed < first_seed + any_seeds; ++seed) {
    Scene scene = scene_of(seed);
    scene.damper().y0 = std::fmin(std::fmax(scene.damper().y0, 0), 1);
    INFO("seed ", seed, ", scene ", scene_text(scene));
    check(scene, options);
  }
}
