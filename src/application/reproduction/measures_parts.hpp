// Curves, and functions of them that measures and figures share; parts of the table of measures.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

#include "application/reproduction/measures.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/responses/response_file.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Return the last entries of a measure's row: the names of the numbers that it requires, and how many scenes
// and responses a claim may name.
template <class... Name>
std::vector<std::string_view> numbers(const Name&... names) {
  return {names...};
}
constexpr Count scenes(std::size_t least, std::size_t most) { return {least, most}; }
constexpr Count responses(std::size_t least, std::size_t most) { return {least, most}; }

struct Curve {
  std::vector<double> x, y;

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
};

using SweepWay = std::vector<SteadyState> Sweep::*;

// Returns for each start the curve that represents several steady motions under the same force: the largest
// amplitude of the motions of one way at each value of the axis. All responses have the same values and
// equally many starts. NaN where one of them has no amplitude, which may be the largest.
inline std::vector<Curve> largest_amplitudes(const std::vector<const SweepResponse*>& responses,
                                             SweepWay way) {
  const std::vector<double> values = responses.front()->axis.values();
  std::vector<Curve> curves(responses.front()->sweeps.size());
  for (std::size_t n = 0; n < curves.size(); ++n) {
    const auto largest_at = [&](std::size_t i) {
      double largest = 0;
      for (const SweepResponse* response : responses) {
        const SteadyState& steady = (response->sweeps.at(n).*way).at(i);
        if (!steady.means) return std::numeric_limits<double>::quiet_NaN();
        largest = std::max(largest, steady.means->amplitude);
      }
      return largest;
    };
    for (std::size_t i = 0; i < values.size(); ++i) curves[n].add(values[i], largest_at(i));
  }
  return curves;
}

inline constexpr double everywhere = std::numeric_limits<double>::infinity();

// Returns one ordinate over the fitted amplitude, in the order of time, where the amplitude lies in [from,
// to]. The first point is left out by default: row 0, which ran from the release and is less than a half
// cycle, is among the peaks that it is fitted to.
enum class FirstPoint { left_out, counted };
Curve loss_curve(const Run& run, LossOrdinate which, const LossFactorOptions& fit, double from = 0,
                 double to = everywhere, FirstPoint first = FirstPoint::left_out);
// Returns it by the averaging of the analysis, where the call asks for it: in its [from, to].
Curve loss_curve(const Asked& asked, const Run& run, LossOrdinate which,
                 FirstPoint first = FirstPoint::left_out);

// Return the slope of y against x, and of ln y against ln x, by least squares.
double slope(const Curve& curve);
double log_slope(Curve curve);

// Returns the mean ordinate of each curve, for each of the bins that all of them reach. The bins are equal in
// ln x on [from, to].
std::vector<std::vector<double>> bin_means(const std::vector<Curve>& curves, double from, double to,
                                           int bins);
// Returns how far curves lie apart at equal x: the largest minus the least of their bin means divided by the
// mean of these, in percent, for each of these bins.
std::vector<double> spreads_percent(const std::vector<Curve>& curves, double from, double to, int bins);

// Return the mean, and the largest, of these. NaN if there is none.
inline double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}
inline double most(const std::vector<double>& values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : *std::ranges::max_element(values);
}

inline const HalfCycles& half_cycles_of(const Run& run) {
  if (!run.half_cycles) throw std::invalid_argument("half_cycles: the run did not record them");
  return *run.half_cycles;
}

inline const Impacts& impacts_of(const Run& run) {
  if (!run.impacts) throw std::invalid_argument("impacts: the run did not record them");
  return *run.impacts;
}

// The parts of the table, by subject.
std::vector<Measure> loss_measures();    // loss factor curves
std::vector<Measure> damper_measures();  // several dampers
std::vector<Measure> regime_measures();  // bounce-down, windows, impact failure, phases
std::vector<Measure> model_measures();   // engine against engine, wall and time step, the paper's slips
std::vector<Measure> steady_measures();  // steady motions under a force

}  // namespace impact_damper
