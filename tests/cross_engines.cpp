#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "impact_damper/simulate.hpp"

using namespace impact_damper;

namespace {

// The largest difference of the half-cycle amplitudes of a compliant wall from those of rigid ones.
double difference(double stiffness, Calibration calibration) {
  Scene scene;
  scene.damper().wall_stiffness = stiffness;
  scene.until_time = 60;
  Exact options;
  options.calibration = calibration;
  const HalfCycles exact = *simulate(scene, options, {}).half_cycles;
  const HalfCycles rigid = *simulate(scene, Restitution{}, {}).half_cycles;
  REQUIRE(exact.amplitude.size() == rigid.amplitude.size());
  double largest = 0;
  for (std::size_t n = 0; n < exact.amplitude.size(); ++n) {
    largest = std::max(largest, std::abs(exact.amplitude[n] - rigid.amplitude[n]));
  }
  return largest;
}

}  // namespace

TEST_CASE("as the wall stiffens the exact engine tends to the restitution engine with order 1/2 in k") {
  // A contact takes pi/omega_c, of order k^(-1/2), while the rigid wall's takes none: all that follows is
  // later by as much. The two-body calibration delivers e itself, so nothing else separates the two models.
  const double at_4 = difference(1e4, Calibration::two_body), at_6 = difference(1e6, Calibration::two_body);
  const double at_8 = difference(1e8, Calibration::two_body), at_10 = difference(1e10, Calibration::two_body);
  const double at_12 = difference(1e12, Calibration::two_body);
  CHECK(at_4 < 0.01);
  for (double order :
       {std::log10(at_6 / at_8) / 2, std::log10(at_8 / at_10) / 2, std::log10(at_10 / at_12) / 2}) {
    CHECK(order > 0.4);
    CHECK(order < 0.6);
  }
}

TEST_CASE("with the fixed-wall calibration the two models stay apart, by the restitution that is delivered") {
  // 0.597 instead of 0.6: that remains when the wall is rigid.
  CHECK(difference(1e12, Calibration::fixed_wall) > 10 * difference(1e12, Calibration::two_body));
}

TEST_CASE("the displacement of an impact is x at its time, in each engine") {
  Scene scene;
  scene.damping_ratio = 0.01;
  scene.force_amplitude = 0.2;
  scene.until_time = 20;
  Cem located;
  located.locate = true;
  for (const Engine& engine : {Engine(Exact{}), Engine(Restitution{}), Engine(Cem{}), Engine(located)}) {
    CAPTURE(name_of(engine));
    Record record;
    record.impacts = true;
    const std::vector<double> times = simulate(scene, engine, record).impacts->time;
    REQUIRE(times.size() > 20);
    // The engine's own state there, as a sample: the last of a window that ends with the impact.
    for (std::size_t i = 0; i < times.size(); i += 3) {
      record.history = {{0, times[i], 2}};
      const Run run = simulate(scene, engine, record);
      // The component element method's samples are the arcs that its impacts are read off.
      CHECK(run.impacts->displacement[i] == doctest::Approx(run.history->x.back()).epsilon(1e-13).scale(1));
    }
  }
}

TEST_CASE("an undamped mass that is left behind is met where it was") {
  // z = x + y stays at x0 until the right wall comes, at x = x0 - 1, when cos t = 1 - 1/x0.
  for (const double x0 : {0.75, 1.5, 6.0, 1e3}) {
    Scene scene;
    scene.x0 = x0;
    scene.until_time = 2.5;
    Record record;
    record.impacts = true;
    for (const Engine& engine : {Engine(Exact{}), Engine(Restitution{})}) {
      const Impacts impacts = *simulate(scene, engine, record).impacts;
      REQUIRE(!impacts.time.empty());
      CHECK(impacts.displacement[0] == doctest::Approx(x0 - 1).epsilon(1e-15 * (1 + x0)).scale(1));
      CHECK(std::cos(impacts.time[0]) == doctest::Approx(1 - 1 / x0).epsilon(1e-14).scale(1));
    }
    // Of first order: the impact is seen up to a step late.
    const Impacts steps = *simulate(scene, Cem{}, record).impacts;
    CHECK(steps.displacement[0] == doctest::Approx(x0 - 1).epsilon(1e-4 * (1 + x0)).scale(1));
  }
}

TEST_CASE(
    "a primary mass that begins at zero sets out to the side to which contact, impact or force drive it") {
  // Which side that is shows first in x', x'' or x''' of the motion that begins there, not of a free flight.
  const auto resting = [] {
    Scene scene;
    scene.x0 = 0;
    scene.until_time = 20;
    return scene;
  };
  Scene struck = resting(), overlapping = resting(), hit_later = resting(), lossless = resting();
  struck.damper().w0 = -1;
  struck.force_amplitude = 0.1;
  overlapping.damper().y0 = -0.01;
  overlapping.force_amplitude = 0.1;
  hit_later.damper().restitution = 1;
  hit_later.damper().mass_ratio = 1;
  hit_later.damper().wall_stiffness = 0.01;
  hit_later.damper().y0 = 0.5;
  hit_later.damper().w0 = 1;
  hit_later.until_time = 160;
  lossless.damper().mass_ratio = 2.041;
  lossless.damper().wall_stiffness = 235.8;
  lossless.damper().restitution = 1;
  lossless.damping_ratio = 0.1;
  lossless.damper().y0 = 1;
  lossless.damper().w0 = 1;
  lossless.until_time = 6;
  for (const Scene& scene : {struck, overlapping, hit_later, lossless}) {
    CAPTURE(scene.damper().y0);
    CAPTURE(scene.damper().mass_ratio);
    Cem steps;
    steps.locate = true;
    const HalfCycles exact = *simulate(scene, Exact{}, {}).half_cycles;
    const HalfCycles cem = *simulate(scene, steps, {}).half_cycles;
    REQUIRE(exact.zero_crossing.size() == cem.zero_crossing.size());
    for (std::size_t row = 0; row < cem.zero_crossing.size(); ++row) {
      // The default step is 1/100 of the fastest half period: 1e-3 is what it leaves after a few impacts.
      CHECK(exact.zero_crossing[row] == doctest::Approx(cem.zero_crossing[row]).epsilon(1e-3));
      CHECK(exact.amplitude[row] == doctest::Approx(cem.amplitude[row]).epsilon(1e-2));
    }
  }
  const HalfCycles rigid = *simulate(struck, Restitution{}, {}).half_cycles;
  CHECK(rigid.zero_crossing[0] ==
        doctest::Approx(simulate(struck, Exact{}, {}).half_cycles->zero_crossing[0]).epsilon(0.1));
}
