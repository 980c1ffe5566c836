#include "impact_damper/events/first_of_many.hpp"

#include <doctest/doctest.h>

#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

using namespace impact_damper;

namespace {

// c[k] is the k-th derivative at time 0 of a polynomial of the fourth degree.
struct Polynomial : Watch<double> {
  std::array<double, 5> c{};
};
Jet<double> jet_of(const Polynomial& p, double t) {
  const auto& c = p.c;
  return {c[0] + t * (c[1] + t * (c[2] / 2 + t * (c[3] / 6 + t * c[4] / 24))),
          c[1] + t * (c[2] + t * (c[3] / 2 + t * c[4] / 6)), c[2] + t * (c[3] + t * c[4] / 2),
          t == 0 ? c[3] : 0};
}
constexpr double horizon = 2;

template <class Guess>
std::optional<ProvenFirst<double>> predicted(std::vector<Polynomial> all, Guess&& guess) {
  Search<double> search{horizon};
  double start = 0;
  return predict_first<double>(
      all, start, [](double t) { return t; },
      [](double, double t, const Polynomial& p) { return jet_of(p, t); }, guess,
      [](const Polynomial& p) { return std::abs(p.c[4]); }, horizon, search);
}
std::optional<Root<double>> searched(std::vector<Polynomial> all) {
  Search<double> search{horizon};
  const auto enclose = [](double, double t, const Polynomial& p) {
    Jet<double> jet = jet_of(p, t);
    jet.third = std::abs(p.c[3] + t * p.c[4]) + std::abs(p.c[4]) * horizon;
    return LocalEnclosure<double>{jet};
  };
  return first_of_many<double>(
      all, [](double t) { return t; }, enclose, horizon, search, 1.0);
}

}  // namespace

TEST_CASE("the first fall of several functions is the same, predicted and proved or searched") {
  std::mt19937 random(1);
  const auto draw = [&] { return double(random()) / 0x1p31 - 1; };
  int falls = 0, none = 0, undecided = 0, late_falls = 0;
  for (int scene = 0; scene < 20'000; ++scene) {
    std::vector<Polynomial> all(1 + random() % 4);
    for (Polynomial& each : all) {
      for (double& c : each.c) c = draw();
      // Positive, or at zero and rising by its first or its second derivative.
      const std::size_t first = random() % 4;
      each.order = first < 3 ? int(first) : 0;
      for (std::size_t k = 0; k < 3; ++k) {
        if (int(k) < each.order) each.c[k] = 0;
        if (int(k) == each.order) each.c[k] = 0.01 + std::abs(each.c[k]);
      }
      // A zero of the first order is the distance of a mass that leaves a wall: its order is not told.
      if (first == 1 && random() % 2 == 0) each.order = 0;
    }
    const auto expected = searched(all);
    // A guess that is no good must not lead to a later fall.
    if (const auto late = predicted(all, [](const Polynomial&) { return 0.9 * horizon; })) {
      REQUIRE(late->root.has_value() == expected.has_value());
      if (expected) CHECK(late->root->which == expected->which);
      if (expected) CHECK(std::abs(late->root->time - expected->time) < 1e-9);
      late_falls += expected.has_value();
    }
    const auto found = predicted(all, [](const Polynomial& p) { return fall_near_parabola(p.start); });
    if (!found) {
      ++undecided;
      continue;
    }
    CAPTURE(scene);
    REQUIRE(found->root.has_value() == expected.has_value());
    ++(expected ? falls : none);
    if (!expected) continue;
    CHECK(found->root->which == expected->which);
    const double slope = jet_of(all[expected->which], expected->time).g1;
    CHECK(std::abs(found->root->time - expected->time) < 1e-15 * (1 + 4 / std::abs(slope)));
  }
  CHECK(falls > 8000);
  CHECK(late_falls > 8000);
  CHECK(none > 1000);
  CHECK(undecided < 4000);
}
