#include "application/measured/decay_fit.hpp"

#include <doctest/doctest.h>

#include <cmath>

#include "impact_damper/simulate.hpp"
#include "made_records.hpp"

using namespace impact_damper;

namespace {

// Released from 40 mm; the scene that is fitted is made::mast() itself.
SceneInUnits truth() {
  SceneInUnits scene = made::mast();
  scene.damper().restitution = 0.5, scene.damping_ratio = 0.003, scene.damper().clearance = 12;
  scene.initial_displacement = 40, scene.until_seconds = 25;
  return scene;
}
const MeasuredRecord& record() {
  static const MeasuredRecord made =
      made::measured(truth(), {.noise = 0.05, .offset = 1, .drift = 1, .seed = 3});
  return made;
}
DecayFit fit_of(const MeasuredRecord& record, Threads threads = {},
                std::vector<FitParameter> parameters = FitOptions{}.parameters,
                std::uint64_t seed = FitOptions{}.seed) {
  const Reduction reduction = reduced("made", record, 3);
  FitOptions options;
  options.threads = threads;
  options.seed = seed;
  options.parameters = std::move(parameters);
  FitResult result = fit_decay(made::mast(), Restitution{}, reduction, loss_bins(reduction), options,
                               [](const std::string&) {});
  REQUIRE(result.fit.has_value());
  return *result.fit;
}
const DecayFit& fit() {
  static const DecayFit fit = fit_of(record());
  return fit;
}
double middle(const DecayFit& fit, std::size_t j) {
  return (fit.parameters[j].low + fit.parameters[j].high) / 2;
}
double width(const DecayFit& fit, std::size_t j) { return fit.parameters[j].high - fit.parameters[j].low; }

}  // namespace

TEST_CASE("a record by another integrator is fitted by the numbers it was made with") {
  for (const FittedParameter& each : fit().parameters) {
    const double expected = value_of(truth(), each.parameter);
    // An interval of 90 % is 3.3 standard deviations wide; this record's truth is within it, and allowed one
    // more on either side: how often it is inside is what measured_coverage counts.
    const double spare = 0.3 * (each.high - each.low);
    CAPTURE(name_of(each.parameter));
    CHECK(expected > each.low - spare);
    CHECK(expected < each.high + spare);
    CHECK(each.high - each.low < 0.25 * expected);
    CHECK_FALSE(each.open_below);
    CHECK_FALSE(each.open_above);
  }
  CHECK(fit().normal_deviate < most_normal_deviate);
}

TEST_CASE("a region that is near the record by chance does not end the search") {
  // Decays with e = 0.75 and a mass ratio of 0.08 scatter, those of a small clearance do not.
  SceneInUnits scene;
  scene.mass = 30, scene.stiffness = 3600, scene.damping_ratio = 0.0033;
  scene.damper().secondary_mass = 2.45, scene.damper().clearance = 2.8, scene.damper().restitution = 0.75;
  scene.damper().secondary_displacement = 0.8;
  scene.initial_displacement = 13.2, scene.until_seconds = 55;
  const double time_unit = scales_of(scene).of(Dimension::time), most = 54.9 / time_unit;
  const Run run = simulate(dimensionless(scene), Restitution{}, {.history = {{0, most, 2501}}});
  MeasuredRecord record;
  for (std::size_t i = 0; i < run.history->time.size(); ++i) {
    record.time.push_back(run.history->time[i] * time_unit);
    record.value.push_back(std::round(2.8e3 * run.history->x[i]) / 1e3);
  }
  const Reduction reduction = reduced("made", record, 3);
  const FitResult result =
      fit_decay(scene, Restitution{}, reduction, loss_bins(reduction), {}, [](const std::string&) {});
  REQUIRE(result.fit);
  CHECK(result.fit->normal_deviate < most_normal_deviate);
  for (const FittedParameter& each : result.fit->parameters) {
    CAPTURE(name_of(each.parameter));
    CHECK(each.low < value_of(scene, each.parameter));
    CHECK(each.high > value_of(scene, each.parameter));
  }
}

TEST_CASE("the fit does not depend on the number of threads") {
  const DecayFit one = fit_of(record(), 1), three = fit_of(record(), 3);
  for (std::size_t j = 0; j < 3; ++j) {
    CHECK(one.parameters[j].best == three.parameters[j].best);
    CHECK(one.parameters[j].low == three.parameters[j].low);
    CHECK(one.parameters[j].high == three.parameters[j].high);
  }
  CHECK(one.chi_square == three.chi_square);
}

TEST_CASE("another seed of the search gives the same intervals") {
  for (const std::uint64_t seed : {2, 3}) {
    const DecayFit other = fit_of(record(), {}, FitOptions{}.parameters, seed);
    for (std::size_t j = 0; j < 3; ++j) {
      CHECK(std::abs(middle(other, j) - middle(fit(), j)) < 0.2 * width(fit(), j));
      CHECK(width(other, j) < 1.5 * width(fit(), j));
    }
  }
}

TEST_CASE("larger displacements are a larger clearance, and nothing else") {
  MeasuredRecord larger = record();
  for (double& each : larger.value) each *= 1.1;
  const DecayFit changed = fit_of(larger);
  CHECK(std::abs(middle(changed, 0) - middle(fit(), 0)) < 0.4 * width(fit(), 0));
  CHECK(std::abs(middle(changed, 1) - middle(fit(), 1)) < 0.4 * width(fit(), 1));
  CHECK(std::abs(middle(changed, 2) - 1.1 * middle(fit(), 2)) < 0.4 * width(fit(), 2));
}

TEST_CASE("a wrong sampling rate changes nothing") {
  MeasuredRecord slower = record();
  for (double& each : slower.time) each *= 1.2;
  const DecayFit changed = fit_of(slower);
  for (std::size_t j = 0; j < 3; ++j)
    CHECK(std::abs(middle(changed, j) - middle(fit(), j)) < 0.2 * width(fit(), j));
}

TEST_CASE("a record of large amplitudes alone does not tell restitution and clearance") {
  MeasuredRecord begin = record();
  const auto end = std::ptrdiff_t(begin.time.size() * 2 / 5);
  begin.time.resize(std::size_t(end)), begin.value.resize(std::size_t(end));
  const DecayFit wide = fit_of(begin);
  CHECK((width(wide, 2) > 3 * width(fit(), 2)));
}

TEST_CASE("losses that no damper of the searched range has are told from those that one has") {
  // The amplitude falls faster at first and slower later on than that of any impact damper.
  MeasuredRecord other = record();
  const Reduction before = reduced("made", record(), 3);
  for (std::size_t i = 0; i < other.time.size(); ++i) {
    const double part = (other.time[i] - other.time[0]) / 8;
    other.value[i] *= std::exp(-0.6 * part * part * std::exp(-part));
  }
  CHECK(fit_of(other).normal_deviate > most_normal_deviate);
}

TEST_CASE(
    "a record with friction is fitted by the true numbers if the scene has it, and by none without it") {
  // The mast's block slides with mu = 0.2: it is held up to 5.1 mm.
  SceneInUnits truth = made::mast();
  truth.damper().restitution = 0.5, truth.damper().secondary_mass = 1.8;
  truth.damper().friction_coefficient = 0.2, truth.damper().contact_stiffness = 1.6e10;
  truth.until_seconds = 16;
  const Scene scene = dimensionless(truth);
  const made::Instrument instrument{.noise = 0.05, .seed = 5};
  const Record samples{.half_cycles = false,
                       .history = {{0, *scene.until_time, made::samples_of(scene, instrument)}}};
  const MeasuredRecord record = made::measured(truth, simulate(scene, Exact{}, samples), instrument);
  const Reduction reduction = reduced("made", record, 3);
  const auto fitted = [&](double friction, double mass, FitParameter second) {
    SceneInUnits given = made::mast();
    given.damper().friction_coefficient = friction, given.damper().secondary_mass = mass;
    FitOptions options;
    options.runs = 200;
    options.parameters = {FitParameter::restitution, second};
    FitResult result =
        fit_decay(given, Restitution{}, reduction, loss_bins(reduction), options, [](const std::string&) {});
    REQUIRE(result.fit.has_value());
    return *result.fit;
  };
  const DecayFit with = fitted(0.2, 1.6, FitParameter::secondary_mass),
                 without = fitted(0, 1.6, FitParameter::secondary_mass),
                 of_friction = fitted(0, 1.8, FitParameter::friction_coefficient);
  for (const DecayFit* fit : {&with, &of_friction}) {
    for (const FittedParameter& each : fit->parameters) {
      const double expected = value_of(truth, each.parameter), spare = 0.3 * (each.high - each.low);
      CAPTURE(name_of(each.parameter));
      CHECK(expected > each.low - spare);
      CHECK(expected < each.high + spare);
      CHECK(each.high - each.low < 0.25 * expected);
    }
    CHECK(fit->normal_deviate < most_normal_deviate);
  }
  CHECK(without.normal_deviate > most_normal_deviate);
  CHECK(without.parameters[1].low > 1.05 * *truth.damper().secondary_mass);
}
