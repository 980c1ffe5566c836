// The averaged loss factor, from the peaks of successive half cycles.
//
// The loss factor is taken per radian, eta = dE / (2 pi E) = -2 A'(t) / A(t) with A the amplitude envelope:
// only then is it 2 zeta for viscous damping alone, which the paper subtracts, and only then do the paper's
// ordinates come out; the "2 dx/x per cycle" of its text is 2 pi times as much.
//
// A'/A at a peak comes from a parabola in time, fitted by least squares to that peak and to equally many
// before and after it. The fit has a bias: on an exponential envelope A = exp(-zeta t) with peaks a time p
// apart it gives 2 zeta (1 + c (zeta p)^2 + ...), c = (3 n^2 + 3 n - 1) / 30 with n = half_cycles / 2;
// c = 89/30 for n = 5, a bias of 0.2 % at zeta = 0.008.
#pragma once

#include <vector>

#include "impact_damper/run.hpp"

namespace impact_damper {

struct LossFactorOptions {
  int half_cycles = 10;  // spanned by the parabola, with half_cycles + 1 peaks; even, 10 to 18
};

// One row per peak that has half_cycles/2 peaks on either side of it, in the order of time: n peaks give
// n - half_cycles rows, none if n <= half_cycles.
struct LossFactor {
  std::vector<double> amplitude;  // the parabola's value at the middle peak, divided by epsilon
  std::vector<double> time;       // of the middle peak, divided by 1/Omega_n
  std::vector<double> eta;        // -2 A'/A there, per radian
};

// `peak_time` strictly ascending, `amplitude` positive, of equal length. Throws std::invalid_argument if
// the columns or the options are not valid.
LossFactor averaged_loss_factor(const std::vector<double>& peak_time, const std::vector<double>& amplitude,
                                const LossFactorOptions& options = {});

// The averaged loss factor from a run's half cycles. Rows of amplitude 0, and rows whose peak is not later
// than the one before (they occur at the start of a run), are left out.
LossFactor averaged_loss_factor(const HalfCycles& half_cycles, const LossFactorOptions& options = {});

// The loss factor without the parabola's bias, for strong damping too: a straight line is fitted by least
// squares to ln A over time, at each peak, with n peaks on either side. n is the largest number up to
// `most_half_cycles` / 2 for which the first and the last of these amplitudes differ by at most `factor`, but
// at least 1, which spans a whole cycle. Exact on an exponential envelope of any decrement; (M12.1), and
// (M12.2) for its bias under impacts.
struct LogarithmicFit {
  double factor = 2;          // >= 1, largest ratio of the first to the last amplitude
  int most_half_cycles = 10;  // even, >= 2
};
// The loss factor by this fit from the rows [first, last) of the half cycles, last <= their number, without
// those left out above. One row per peak that has a neighbour on either side; its amplitude is the geometric
// mean of the peaks that its line is fitted to. Nothing is checked or thrown.
LossFactor local_loss_factor(const HalfCycles& half_cycles, std::size_t first, std::size_t last,
                             const LogarithmicFit& fit = {});

// local_loss_factor() of a run before impact failure and above its amplitude (regimes.hpp). Row 0, which is
// less than a half cycle, is left out. Needs half_cycles.
LossFactor loss_before_failure(const Run& run);

// The ordinates of figures; A is the amplitude, nu, zeta and e are the scene's.
enum class LossOrdinate {
  eta,
  specific,            // eta/nu: "specific total loss factor"
  specific_secondary,  // (eta - 2 zeta)/nu: "specific secondary mass loss factor", of the impacts alone
  amplitude_times,     // A (eta - 2 zeta)/nu, of Figures 12 and 13
  by_restitution,      // A (eta - 2 zeta)/nu divided by 1 - e, e < 1, of Figure 14
  // A (eta - 2 zeta/(1 + nu))/nu: the primary mass carries the secondary along (M11.3, from M11.1 and M11.2).
  carried,
};
// One of these for every row of `loss`.
std::vector<double> ordinate(const LossFactor& loss, const Scene& scene, LossOrdinate which);

}  // namespace impact_damper
