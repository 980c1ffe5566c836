#include "impact_damper/motion/wall.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <numbers>

using namespace impact_damper;

TEST_CASE("the closed form gives back the restitution it came from") {
  for (double e : {1e-6, 0.01, 0.4, 0.6, 0.8, 0.99, 1 - 1e-12}) {
    const double z = zeta_m_closed_form(e);
    CHECK(std::exp(-std::numbers::pi * z / std::sqrt((1 - z) * (1 + z))) == doctest::Approx(e).epsilon(1e-9));
  }
  CHECK(zeta_m_closed_form(1.0) == 0);
  CHECK(zeta_m_closed_form(0.0) == 1);
}

TEST_CASE(
    "the paper's iterative subroutine finds the closed form's zeta_m to its 1e-8 in at least 100 steps") {
  for (double e : {1.0, 0.99, 0.8, 0.6, 0.4, 0.1, 0.01}) {
    const IterativeZeta found = zeta_m_iterative(e);
    CHECK(found.steps >= 100);
    CHECK(found.velocity_error <= 1e-8);
    // |de/dzeta| >= 0.03 over these e: a velocity error of 1e-8 is at most 4e-7 in zeta_m.
    CHECK(std::abs(found.zeta_m - zeta_m_closed_form(e)) < 4e-7);
    CHECK(std::abs(zeta_m_iterative(e, 1e-13).zeta_m - zeta_m_closed_form(e)) < 4e-12);
  }
}
