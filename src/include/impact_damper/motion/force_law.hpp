// The force of a wall or of the primary spring over its deformation, where it is not linear
// (docs/mathematics.md, 18.6): increasing, zero at zero. Forces are divided by K epsilon, lengths by epsilon.
#pragma once

#include <cstddef>
#include <vector>

#include "impact_damper/scene.hpp"

namespace impact_damper {

class ForceLaw {
 public:
  // P of (M18.13), as an odd function: negative at the left wall. The scene must be valid (problems_of).
  static ForceLaw of_wall(const SceneDamper& damper);
  // S of (M18.15).
  static ForceLaw of_spring(const SpringLaw& spring);

  double force(double q) const;
  double slope(double q) const;   // of the force
  double energy(double q) const;  // the integral of the force from 0
  // Returns the largest |q| at which the energy is at most `energy` on either side.
  double farthest(double energy) const;
  // Returns the steepest slope that a motion can meet with this energy, (M18.18).
  double steepest(double energy) const;

 private:
  // A piece of a table from `at` to the next one; the first and the last go on beyond the ends.
  struct Piece {
    double at, force, energy, slope;
  };
  void set_table(const Pairs& pairs);
  const Piece& piece_at(double q) const;

  double linear_ = 0, cubic_ = 0, factor_ = 0, exponent_ = 1;  // without a table: l q + c q^3 + k q^p
  std::vector<Piece> pieces_;
};

// Returns chi v for which a mass that meets a wall with the force (1 + chi w) P(q) at the speed v leaves it
// with e v, the root of (M18.14), for e of least_restitution_of_law to 1.
double loss_at_unit_speed(double restitution);
// Returns chi of a damper's wall, which must not be linear.
double loss_factor_of(const SceneDamper& damper);

}  // namespace impact_damper
