// The parts of a fit against closed forms, and one small fit: decay_fit.cpp has the full ones.
#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

#include "application/measured/comparison.hpp"
#include "application/measured/decay_fit.hpp"
#include "made_records.hpp"

using namespace impact_damper;

namespace {

// Half cycles of a decay that loses `eta` per radian for `many` of them, then `later`, at a frequency that is
// larger by 3 %. Each amplitude errs by a thousandth.
Reduction two_losses(int many, double eta, double later) {
  constexpr double omega = 20, faster = 1.03;
  Reduction r;
  double time = 0.3, logarithm = 3;
  for (int i = 0; i < 2 * many; ++i) {
    r.time.push_back(time), r.half_cycle.push_back(i);
    r.amplitude.push_back(std::exp(logarithm)), r.error.push_back(1e-3 * std::exp(logarithm));
    const bool is_late = i + 1 >= many;
    time += std::numbers::pi / omega / (is_late ? faster : 1);
    logarithm -= (is_late ? later : eta) / 2 * std::numbers::pi;
  }
  r.frequency = double(2 * many - 1) / 2 / (r.time.back() - r.time.front());
  return r;
}

// Heavily damped, so that it ends soon.
SceneInUnits heavy() {
  SceneInUnits scene = made::mast();
  scene.damper().secondary_mass = 4, scene.damper().restitution = 0.4, scene.damping_ratio = 0.004,
  scene.damper().clearance = 8;
  scene.initial_displacement = 30, scene.until_seconds = 9;
  return scene;
}

}  // namespace

TEST_CASE("bins have the loss per radian of their own frequency, its error, and end where impacts fail") {
  constexpr double eta = 0.05;
  const std::vector<LossBin> bins = loss_bins(two_losses(60, eta, eta / 10));
  REQUIRE(bins.size() >= 5);
  for (const LossBin& each : bins) {
    CHECK(std::abs(each.loss / eta - 1) < 2e-3);  // the last one may have a row behind
    CHECK(each.half_cycles >= 8);
  }
  CHECK(bins.back().lower > std::exp(3 - 61 * eta / 2 * std::numbers::pi));
  // Of n equidistant points with equal errors s the slope has the variance 12 s^2 / (n (n^2 - 1)).
  const double n = double(bins[0].half_cycles), fall = eta / 2 * std::numbers::pi;
  const double error = 1e-3 * std::sqrt(12 / (n * (n * n - 1))) / fall;
  CHECK(std::abs(bins[0].error / error - 1) < 1e-9);
}

TEST_CASE("no bin reaches across a gap") {
  Reduction r = two_losses(60, 0.05, 0.05);
  const auto lost = [&](auto& column) { column.erase(column.begin() + 20, column.begin() + 28); };
  lost(r.time), lost(r.half_cycle), lost(r.amplitude), lost(r.error);
  const std::vector<LossBin> bins = loss_bins(r);
  REQUIRE(bins.size() >= 5);
  for (const LossBin& each : bins) CHECK((each.lower >= r.amplitude[19] || each.upper <= r.amplitude[20]));
}

TEST_CASE("the statistic of a simulated decay of known loss is that loss") {
  // Without impacts, the secondary mass at rest in the middle of a wide cavity, eta = 2 zeta / sqrt(1 -
  // zeta^2).
  Scene scene{.damping_ratio = 0.01,
              .x0 = 0.05,
              .until_time = 400,
              .until_amplitude = 0.004,
              .dampers = {{.y0 = 0.5}}};
  const HalfCycles rows = simulated_half_cycles(scene, Restitution{});
  const std::vector<LossBin> bins{{0.04, 0.02}, {0.02, 0.01}, {0.01, 0.005}};
  const auto losses = log_losses(rows, 1, bins);
  REQUIRE(losses.size() == bins.size());
  for (const double each : losses) CHECK(std::abs(std::exp(each) / 0.02 * std::sqrt(1 - 1e-4) - 1) < 1e-4);
  CHECK(log_losses(rows, 1, {{0.0035, 0.001}}).empty());
  CHECK(log_losses(rows, 1, {{0.2, 0.1}}).empty());  // above the whole decay
  CHECK(log_losses(rows, 1, {bins[0], {0.0035, 0.001}}).size() == 1);
}

TEST_CASE("a small fit finds what a record was made with, for any number of threads") {
  const Reduction reduction = reduced("made", made::measured(heavy(), {.noise = 0.02, .seed = 8}), 3);
  const std::vector<LossBin> bins = loss_bins(reduction);
  SceneInUnits scene = heavy();
  scene.damper().secondary_mass = 3, scene.damper().restitution = 0.6;
  FitOptions options;
  options.parameters = {FitParameter::restitution, FitParameter::secondary_mass};
  options.runs = 120;
  options.threads = 1;
  const auto fitted = [&](const FitOptions& with, const std::vector<LossBin>& of) {
    FitResult result = fit_decay(scene, Restitution{}, reduction, of, with, [](const std::string&) {});
    REQUIRE(result.fit.has_value());
    return *result.fit;
  };
  const auto width = [](const DecayFit& fit, std::size_t j) {
    return fit.parameters[j].high - fit.parameters[j].low;
  };
  const DecayFit fit = fitted(options, bins);
  for (const FittedParameter& each : fit.parameters) {
    CAPTURE(name_of(each.parameter));
    // As in decay_fit.cpp: one standard deviation more on either side than an interval of 90 %.
    const double truth = value_of(heavy(), each.parameter), spare = 0.3 * (each.high - each.low);
    CHECK(each.low - spare < truth);
    CHECK(truth < each.high + spare);
    CHECK(each.high - each.low < 0.1 * truth);
    CHECK(each.low < each.best);
    CHECK(each.best < each.high);
    CHECK_FALSE((each.open_below || each.open_above));
  }
  // (M16.9), and 90 % of a normal distribution.
  const double n = double(fit.degrees), ninth = 2 / (9 * n);
  CHECK(fit.degrees == std::int64_t(bins.size()) - 2);
  CHECK(fit.normal_deviate ==
        doctest::Approx((std::cbrt(fit.chi_square / n) - 1 + ninth) / std::sqrt(ninth)));
  CHECK(std::erf(std::sqrt(options.level / 2)) == doctest::Approx(0.9).epsilon(1e-6));

  options.threads = 3, options.level *= 4;
  const DecayFit wide = fitted(options, bins);
  CHECK(wide.chi_square == fit.chi_square);
  // chi square is nearly a parabola, and nothing but the level differs.
  for (std::size_t j = 0; j < 2; ++j) {
    CHECK(wide.parameters[j].best == fit.parameters[j].best);
    CHECK(width(wide, j) == doctest::Approx(2 * width(fit, j)).epsilon(0.1));
  }

  // Noise that is far more than the scatter makes all intervals wider.
  options.threads = {}, options.level /= 4;
  std::vector<LossBin> noisy = bins;
  for (LossBin& each : noisy) each.error += 0.15;
  const DecayFit unsure = fitted(options, noisy);
  for (std::size_t j = 0; j < 2; ++j) CHECK(width(unsure, j) > 2 * width(fit, j));

  const FitResult none =
      fit_decay(scene, Restitution{}, reduction, {bins[0], bins[1]}, options, [](const std::string&) {});
  CHECK_FALSE(none.fit.has_value());
  CHECK(none.problem ==
        "a fit of 2 numbers needs 3 ranges of amplitude with a known loss factor, the record has 2");
}

TEST_CASE("a fit for which an option is out of range, or of a list of dampers, is rejected") {
  Reduction reduction;
  const auto fields = [&](const SceneInUnits& scene, const FitOptions& options) {
    std::vector<std::string> names;
    try {
      fit_decay(scene, Restitution{}, reduction, {}, options, [](const std::string&) {});
    } catch (const InvalidArguments& error) {
      for (const Problem& problem : error.problems()) names.push_back(problem.field);
    }
    return names;
  };
  using Names = std::vector<std::string>;
  CHECK(fields(heavy(), {}).empty());
  FitOptions options;
  options.parameters.push_back(options.parameters.front());
  options.runs = 0, options.level = std::nan("");
  CHECK(fields(heavy(), options) == Names{"parameters", "runs", "level"});
  options = {};
  options.parameters.clear();
  CHECK(fields(heavy(), options) == Names{"parameters"});
  SceneInUnits list = heavy();
  list.dampers.push_back({.secondary_mass = 4, .clearance = 8});
  CHECK(fields(list, {}) == Names{"dampers"});
  options.parameters = {FitParameter::restitution, FitParameter::damping_ratio, FitParameter::clearance,
                        FitParameter::secondary_mass};
  CHECK(fields(heavy(), options).empty());
  options.parameters.push_back(FitParameter::friction_coefficient);
  CHECK(fields(heavy(), options) == Names{"parameters"});
  options.parameters = {FitParameter::friction_coefficient};
  SceneInUnits held = heavy();
  held.damper().static_friction_coefficient = 0.3, held.gravity = 0;
  CHECK(fields(held, options) == Names{"static_friction_coefficient", "gravity"});
  CHECK(fields(held, {}).empty());

  // The same before a comparison begins.
  const auto compare = [&](const SceneInUnits& scene, const ComparisonOptions& with) {
    compared("r", {}, "s", scene, Restitution{}, with, [](const std::string&) {});
  };
  CHECK_THROWS_AS(compare(list, {}), InvalidArguments);
  CHECK_THROWS_AS(compare(heavy(), {.releases = 0}), InvalidArguments);
}

TEST_CASE("a simulated decay needs a time at which it ends") {
  CHECK_THROWS_AS(simulated_half_cycles({.until_amplitude = 1}, Restitution{}), InvalidArguments);
}
