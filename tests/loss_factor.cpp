#include "impact_damper/analysis/loss_factor.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>
#include <stdexcept>

using namespace impact_damper;
constexpr double pi = std::numbers::pi;

namespace {
struct Peaks {
  std::vector<double> time, amplitude;
};
// Peaks of a viscous oscillator released from rest: pi / sqrt(1 - zeta^2) apart, on exp(-zeta t).
Peaks viscous(double zeta, int count) {
  Peaks peaks;
  for (int i = 0; i < count; ++i) {
    peaks.time.push_back(i * pi / std::sqrt(1 - zeta * zeta));
    peaks.amplitude.push_back(6 * std::exp(-zeta * peaks.time.back()));
  }
  return peaks;
}
}  // namespace

TEST_CASE("a viscous oscillator has the loss factor 2 zeta, with the bias of the parabola as predicted") {
  for (double zeta : {1e-4, 1e-3, 0.002, 0.004, 0.008})
    for (int half_cycles : {10, 12, 14, 16, 18}) {
      const Peaks peaks = viscous(zeta, 40);
      const LossFactor loss = averaged_loss_factor(peaks.time, peaks.amplitude, {half_cycles});
      REQUIRE(loss.eta.size() == 40 - static_cast<std::size_t>(half_cycles));
      const double n = half_cycles / 2, p = zeta * pi;
      const double bias = (3 * n * n + 3 * n - 1) / 30 * p * p;
      // What is left is of fourth order in the decay over half the window, n p.
      for (double eta : loss.eta) CHECK(std::abs(eta / (2 * zeta) - 1 - bias) < std::pow(n * p, 4) + 1e-10);
    }
}

TEST_CASE("a parabola of unequally spaced peaks is met exactly, value and slope") {
  Peaks peaks;
  for (int i = 0; i < 19; ++i) {
    peaks.time.push_back(1000 + 3.1 * i + 0.4 * std::sin(7.0 * i));  // far from 0: centring is needed
    const double s = peaks.time.back() - 1025;
    peaks.amplitude.push_back(3 - 0.02 * s + 1e-4 * s * s);
  }
  for (int half_cycles : {10, 18}) {
    const LossFactor loss = averaged_loss_factor(peaks.time, peaks.amplitude, {half_cycles});
    REQUIRE(!loss.eta.empty());
    for (std::size_t i = 0; i < loss.eta.size(); ++i) {
      const double s = loss.time[i] - 1025;
      const double a = 3 - 0.02 * s + 1e-4 * s * s;
      CHECK(std::abs(loss.amplitude[i] - a) < 1e-13 * a);
      CHECK(std::abs(loss.eta[i] + 2 * (-0.02 + 2e-4 * s) / a) < 1e-14);
    }
  }
}

TEST_CASE("noise that a parabola of eleven points cannot hold is taken out as the normal equations say") {
  // Least squares by the orthogonal polynomials on -5 ... 5, written out: slope = sum i A_i / 110,
  // value = sum (89 - 5 i^2) A_i / 429.
  Peaks peaks;
  for (int i = 0; i < 11; ++i) {
    peaks.time.push_back(pi * i);
    peaks.amplitude.push_back(1 + 0.1 * std::cos(5.0 * i * i));
  }
  double slope = 0, value = 0;
  for (int i = -5; i <= 5; ++i) {
    const double a = peaks.amplitude[static_cast<std::size_t>(i + 5)];
    slope += i * a / 110;
    value += (89 - 5 * i * i) * a / 429;
  }
  const LossFactor loss = averaged_loss_factor(peaks.time, peaks.amplitude);
  REQUIRE(loss.eta.size() == 1);
  CHECK(loss.amplitude[0] == doctest::Approx(value).epsilon(1e-14));
  CHECK(loss.eta[0] == doctest::Approx(-2 * slope / (pi * value)).epsilon(1e-13));
  CHECK(loss.time[0] == peaks.time[5]);
}

TEST_CASE("fewer peaks than the window give no rows, and one more than that gives one") {
  for (int count : {0, 1, 10}) {
    const Peaks peaks = viscous(0.01, count);
    CHECK(averaged_loss_factor(peaks.time, peaks.amplitude).eta.empty());
  }
  const Peaks peaks = viscous(0.01, 11);
  CHECK(averaged_loss_factor(peaks.time, peaks.amplitude).eta.size() == 1);
}

TEST_CASE("what is not valid is rejected") {
  const Peaks peaks = viscous(0.01, 20);
  for (int half_cycles : {0, 8, 11, 20, -10})
    CHECK_THROWS_AS(averaged_loss_factor(peaks.time, peaks.amplitude, {half_cycles}), std::invalid_argument);
  CHECK_THROWS_AS(averaged_loss_factor({0, 1}, {1}), std::invalid_argument);
  CHECK_THROWS_AS(averaged_loss_factor({0, 0}, {1, 1}), std::invalid_argument);
  CHECK_THROWS_AS(averaged_loss_factor({0, 1}, {1, 0}), std::invalid_argument);
  CHECK_THROWS_AS(averaged_loss_factor({0, std::nan("")}, {1, 1}), std::invalid_argument);
}

TEST_CASE("the ordinates of the figures are made of eta as their names say") {
  const Scene scene{.damping_ratio = 0.004, .dampers = {{.mass_ratio = 0.02, .restitution = 0.6}}};
  const LossFactor loss{{0.5}, {0}, {0.018}};
  CHECK(ordinate(loss, scene, LossOrdinate::eta)[0] == 0.018);
  CHECK(ordinate(loss, scene, LossOrdinate::specific)[0] == doctest::Approx(0.9));
  CHECK(ordinate(loss, scene, LossOrdinate::specific_secondary)[0] == doctest::Approx(0.5));
  CHECK(ordinate(loss, scene, LossOrdinate::amplitude_times)[0] == doctest::Approx(0.25));
  CHECK(ordinate(loss, scene, LossOrdinate::by_restitution)[0] == doctest::Approx(0.625));
}

TEST_CASE("a half cycle of no height, or whose peak does not lie behind the last, is no peak") {
  HalfCycles rows;
  rows.peak_time = {0, 0};
  rows.amplitude = {0, 1};
  for (int i = 1; i < 12; ++i) {
    rows.peak_time.push_back(i);
    rows.amplitude.push_back(1);
  }
  CHECK(averaged_loss_factor(rows).eta.size() == 2);
}
