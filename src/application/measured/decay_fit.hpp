// Restitution, viscous damping, clearance, secondary mass and friction from a measured decay, with intervals
// (docs/mathematics.md, 16.2 and 16.3).
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "application/measured/reduction.hpp"
#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/run.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper {

// A range of amplitudes and the mean loss factor in it (M16.5).
struct LossBin {
  double upper = 0, lower = 0;  // mm
  double loss = 0;              // eta, per radian
  double error = 0;             // standard error of ln eta by the noise of the record
  std::int64_t half_cycles = 0;
};
// Returns the bins of a record in the order of time. They end where the loss factor is less than half of the
// largest before: impacts have failed there. Empty if no range of amplitudes has a known loss factor.
std::vector<LossBin> loss_bins(const Reduction& reduction);

// ln eta of each bin in a simulated decay, up to the first bin with no loss or for which the decay has too
// few rows left. A bin with fewer than four rows also uses neighbouring rows. Amplitudes in units of `length`
// mm.
std::vector<double> log_losses(const HalfCycles& rows, double length, const std::vector<LossBin>& bins);

enum class FitParameter { restitution, damping_ratio, clearance, secondary_mass, friction_coefficient };
// Whether it is 0 or more; else it is more than 0 and, where it is the restitution, less than 1.
constexpr bool is_bounded_by_0(FitParameter parameter) {
  return parameter == FitParameter::damping_ratio || parameter == FitParameter::friction_coefficient;
}
std::string_view unit_of(FitParameter parameter);
double value_of(const SceneInUnits& scene, FitParameter parameter);
void set_value(SceneInUnits& scene, FitParameter parameter, double value);

// Returns the dimensionless scene of a free decay through the amplitudes of the record: released at rest 10 %
// above the first of them, followed to 3 % below `until` mm. `seed` and `draw` decide where in its cavity the
// secondary mass is released.
Scene decay_scene(const SceneInUnits& scene, const Reduction& reduction, double until, std::uint64_t seed,
                  std::int64_t draw);

struct FitOptions {
  // At most 4, without repetition; fit_decay() needs at least 1.
  std::vector<FitParameter> parameters{FitParameter::restitution, FitParameter::damping_ratio,
                                       FitParameter::clearance};
  std::int64_t runs = 800;  // >= 1, in each stage; twice as many in the last
  std::uint64_t seed = 1;
  double level = 2.705543;  // > 0, limit in (M16.8); the default gives intervals of 90 %
  Threads threads;
};

struct FittedParameter {
  FitParameter parameter = FitParameter::restitution;
  double best = 0, low = 0, high = 0;  // (M16.8)
  double searched_from = 0, searched_to = 0;
  // The interval does not end within the searched range on that side.
  bool open_below = false, open_above = false;
};

struct DecayFit {
  std::vector<FittedParameter> parameters;
  std::vector<std::vector<double>> correlation;  // of the parameters' coordinates (M16.6)
  std::vector<double> loss;                      // of each bin at the best point
  std::vector<double>
      scatter;                // standard deviation of ln eta between runs that differ in their release alone
  double chi_square = 0;      // least value of (M16.7)
  std::int64_t degrees = 0;   // degrees of freedom: bins minus parameters
  double normal_deviate = 0;  // of chi_square (M16.9)
  std::int64_t runs = 0;      // simulated in all
};
// Chance exceeds this normal deviate of chi_square once in a thousand. Above it no point of the searched
// range is like the record.
inline constexpr double most_normal_deviate = 3.09;

// Without a fit `problem` says why.
struct FitResult {
  std::optional<DecayFit> fit;
  std::string problem;
};
// Returns the problems of the options, and of a scene with a list of dampers or, if friction is fitted, with
// a static friction of its own or without gravity. An empty list of parameters is not a problem here.
std::vector<Problem> problems_of_fit(const SceneInUnits& scene, const FitOptions& options);
// Fits the parameters to the record's loss factors (M16.7). The scene must be valid, without a force and with
// one damper, not a list; `bins` are those of loss_bins(). `tell`, which must not be empty, receives messages
// about the progress. No result depends on the number of threads. Throws InvalidArguments for a list of
// dampers and for options out of range.
FitResult fit_decay(const SceneInUnits& scene, const Engine& engine, const Reduction& reduction,
                    const std::vector<LossBin>& bins, const FitOptions& options,
                    const std::function<void(const std::string&)>& tell);

// How a decay without impacts was recorded: with the secondary mass locked to the primary one, or taken out.
enum class WithoutImpacts { locked, absent };
// The mass ratio of what is carried along in such a decay of the scene.
double locked_mass_ratio(const SceneInUnits& scene, WithoutImpacts without);
// Fits the damping ratio to the loss factors of such a decay (M16.11).
FitResult fit_without_impacts(double locked_mass_ratio, const std::vector<LossBin>& bins);

}  // namespace impact_damper
