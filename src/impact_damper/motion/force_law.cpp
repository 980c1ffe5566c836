#include "impact_damper/motion/force_law.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>

#include "impact_damper/math/elementary.hpp"

namespace impact_damper {
namespace {

// Returns the last value from `low` on at which `holds`, which is true there; with `high` infinite after it
// has been looked for by doubling.
template <class Holds>
double last_where(double low, double high, Holds&& holds) {
  double step = 1;
  while (high == std::numeric_limits<double>::infinity()) {
    if (!holds(low + step)) high = low + step;
    step *= 2;
  }
  for (;;) {
    const double middle = low + (high - low) / 2;
    if (!(middle > low && middle < high)) return low;
    (holds(middle) ? low : high) = middle;
  }
}

// (u - ln(1 + u)) / u^2 for u > -1.
double excess_of_logarithm(double u) {
  if (absolute(u) > 0.1) return (u - logarithm(1 + u)) / (u * u);
  double sum = 0;  // 1/2 - u/3 + u^2/4 - ...
  for (int n = 18; n >= 2; --n) sum = 1.0 / n - u * sum;
  return sum;
}

}  // namespace

ForceLaw ForceLaw::of_wall(const SceneDamper& damper) {
  ForceLaw law;
  switch (damper.wall.law) {
    case WallForm::linear:
      law.linear_ = damper.wall_stiffness;
      break;
    case WallForm::power:
      law.factor_ = damper.wall_stiffness;
      law.exponent_ = damper.wall.exponent;
      break;
    case WallForm::table:
      law.set_table(damper.wall.pairs);
      break;
  }
  return law;
}

ForceLaw ForceLaw::of_spring(const SpringLaw& spring) {
  ForceLaw law;
  switch (spring.law) {
    case SpringForm::cubic:
      law.linear_ = 1;
      law.cubic_ = spring.cubic;
      break;
    case SpringForm::table:
      law.set_table(spring.pairs);
      break;
  }
  return law;
}

void ForceLaw::set_table(const Pairs& pairs) {
  Pairs all;
  if (pairs.front()[0] == 0)
    for (auto each = pairs.rbegin(); each + 1 != pairs.rend(); ++each)
      all.push_back({-(*each)[0], -(*each)[1]});
  all.insert(all.end(), pairs.begin(), pairs.end());
  double energy = 0, at_zero = 0;
  for (std::size_t i = 0; i + 1 < all.size(); ++i) {
    const auto [at, force] = all[i];
    const auto [to, then] = all[i + 1];
    if (at == 0) at_zero = energy;
    pieces_.push_back({at, force, energy, (then - force) / (to - at)});
    energy += (to - at) * (force + then) / 2;
    if (to == 0) at_zero = energy;
  }
  for (Piece& piece : pieces_) piece.energy -= at_zero;
}

const ForceLaw::Piece& ForceLaw::piece_at(double q) const {
  const auto next = std::upper_bound(pieces_.begin(), pieces_.end(), q,
                                     [](double value, const Piece& piece) { return value < piece.at; });
  return next == pieces_.begin() ? pieces_.front() : *(next - 1);
}

double ForceLaw::force(double q) const {
  if (!pieces_.empty()) {
    const Piece& piece = piece_at(q);
    return piece.force + (q - piece.at) * piece.slope;
  }
  const double of_polynomial = q * (linear_ + cubic_ * (q * q));
  if (factor_ == 0 || q == 0) return of_polynomial;
  const double power = factor_ * exponential(exponent_ * logarithm(absolute(q)));
  return q > 0 ? power : -power;
}

double ForceLaw::slope(double q) const {
  if (!pieces_.empty()) return piece_at(q).slope;
  if (factor_ != 0) return q == 0 ? (exponent_ > 1 ? 0 : factor_) : exponent_ * (force(q) / q);
  return linear_ + 3 * cubic_ * (q * q);
}

double ForceLaw::energy(double q) const {
  if (!pieces_.empty()) {
    const Piece& piece = piece_at(q);
    const double on = q - piece.at;
    return piece.energy + on * (piece.force + on * piece.slope / 2);
  }
  if (factor_ != 0) return force(q) * q / (exponent_ + 1);
  const double square = q * q;
  return square * (linear_ / 2 + cubic_ / 4 * square);
}

double ForceLaw::farthest(double energy) const {
  const double infinity = std::numeric_limits<double>::infinity();
  double far = 0;
  for (const double side : {-1.0, 1.0})
    far = std::max(far, last_where(0, infinity, [&](double q) { return this->energy(side * q) <= energy; }));
  return far;
}

double ForceLaw::steepest(double energy) const {
  const double far = farthest(energy);
  if (pieces_.empty()) return slope(far);
  double steepest = 0;
  for (std::size_t i = 0; i < pieces_.size(); ++i) {
    const bool begins = i == 0 || pieces_[i].at <= far,
               ends = i + 1 < pieces_.size() && pieces_[i + 1].at < -far;
    if (begins && !ends) steepest = std::max(steepest, pieces_[i].slope);
  }
  return steepest;
}

double loss_at_unit_speed(double restitution) {
  const double e = restitution;
  if (e >= 1) return 0;
  // In u = chi v the left side of (M18.14) exceeds the right one up to the root, which is the only one.
  return last_where((1 - e) / e, 1 / e, [&](double u) {
    return e * u < 1 && e * e * excess_of_logarithm(-e * u) <= excess_of_logarithm(u);
  });
}

double loss_factor_of(const SceneDamper& damper) {
  return loss_at_unit_speed(damper.restitution) / damper.wall.speed.value_or(1);
}

}  // namespace impact_damper
