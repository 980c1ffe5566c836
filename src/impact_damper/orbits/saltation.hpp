// Saltation matrices: what an event does to small changes of the state (docs/mathematics.md, 13.3).
#pragma once

#include <array>
#include <cstddef>

#include "impact_damper/motion/state.hpp"

namespace impact_damper {

// Rows: x, v, y, w.
template <class Real, std::size_t columns>
using RowsOfState = std::array<std::array<Real, columns>, 4>;

template <class Real, std::size_t columns>
RowsOfState<Real, columns> product(const RowsOfState<Real, 4>& a, const RowsOfState<Real, columns>& b) {
  RowsOfState<Real, columns> c{};
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < columns; ++j)
      for (std::size_t k = 0; k < 4; ++k) c[i][j] += a[i][k] * b[k][j];
  return c;
}

template <class Real>
RowsOfState<Real, 4> identity() {
  RowsOfState<Real, 4> one{};
  for (std::size_t i = 0; i < 4; ++i) one[i][i] = 1;
  return one;
}

// x', x'', y', y'' in a state.
template <class Real>
using Rates = std::array<Real, 4>;
template <class Real>
Rates<Real> rates_in_flight(const Real& zeta, const State<Real>& s, const Real& force) {
  const Real a = force - 2 * zeta * s.v - s.x;
  return {s.v, a, s.w, -a};
}

// The saltation matrix D + (after - D before) n^T / w, n^T the row of y (M13.4). jump: D, the derivative of
// the state's jump; before, after: the rates F^-, F^+ at the event; w, y' before it, is not 0.
template <class Real>
RowsOfState<Real, 4> saltation(const RowsOfState<Real, 4>& jump, const Rates<Real>& before,
                               const Rates<Real>& after, const Real& w) {
  RowsOfState<Real, 4> s = jump;
  for (std::size_t i = 0; i < 4; ++i) {
    Real kick = after[i];  // row i of F^+ - D F^-
    for (std::size_t k = 0; k < 4; ++k) kick -= jump[i][k] * before[k];
    s[i][2] += kick / w;
  }
  return s;
}

// The derivative of an impact on a rigid wall, the D of (M13.5): x and y stay, v gains
// nu (1+e) w / (1+nu), w becomes -e w.
template <class Real>
RowsOfState<Real, 4> impact_jump(const Real& nu, const Real& e) {
  RowsOfState<Real, 4> jump = identity<Real>();
  jump[1][3] = nu * (1 + e) / (1 + nu);
  jump[3][3] = -e;
  return jump;
}
// The D of both masses joining: their centre of mass goes on, y and w no longer vary (M13.7).
template <class Real>
RowsOfState<Real, 4> joining_jump(const Real& nu) {
  const Real share = nu / (1 + nu);
  return {{{1, 0, share, 0}, {0, 1, 0, share}, {0, 0, 0, 0}, {0, 0, 0, 0}}};
}
// The saltation matrix of touch (sign 1) or end (-1) of a contact with a compliant wall of the damping c
// (M13.6): only the force of the wall's damper jumps.
template <class Real>
RowsOfState<Real, 4> contact_edge(const Real& nu, const Real& c, int sign) {
  RowsOfState<Real, 4> s = identity<Real>();
  s[1][2] = sign * nu * c;
  s[3][2] = -sign * (1 + nu) * c;
  return s;
}

}  // namespace impact_damper
