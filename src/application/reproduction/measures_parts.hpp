// What measures and figures share: curves, statistics of them, and the records of a run. Each source
// measures_*.cpp makes one part of the table of measures, by the functions at the end.
#pragma once

#include <algorithm>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string_view>
#include <vector>

#include "application/reproduction/measures.hpp"
#include "impact_damper/analysis/loss_factor.hpp"
#include "impact_damper/responses/response_file.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Return the last entries of a measure's row (Measure): the names of the numbers that its call must give, and
// the least and the greatest number of scenes, or of responses, that the call may name.
template <class... Name>
std::vector<std::string_view> numbers(const Name&... names) {
  return {names...};
}
constexpr Count scenes(std::size_t least, std::size_t most) { return {least, most}; }
constexpr Count responses(std::size_t least, std::size_t most) { return {least, most}; }

// Points in the order in which they were found, by time or along an axis; x and y have equal lengths.
struct Curve {
  std::vector<double> x, y;

  void add(double at, double value) {
    x.push_back(at);
    y.push_back(value);
  }
};

using SweepWay = std::vector<SteadyState> Sweep::*;  // &Sweep::up or &Sweep::down

// Returns one curve for each start of the responses, of which there must be one or more, on the same axis and
// with equally many starts: at each value of the axis the largest of the amplitudes that the responses'
// motions have there, swept that way. A motion without amplitude might have had the largest, so that there
// the curve is NaN.
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

// An upper end of amplitudes that excludes none.
inline constexpr double everywhere = std::numeric_limits<double>::infinity();

// Whether a loss curve has its first point. That is fitted to the run's first peaks, among them the one of
// the time from the release to the first zero crossing, which is less than a half cycle.
enum class FirstPoint { left_out, counted };
// Returns the ordinate `which` over the fitted amplitude, in units of the clearance, for amplitudes in [from,
// to]. Throws std::invalid_argument where the run did not record its half cycles.
Curve loss_curve(const Run& run, LossOrdinate which, const LossFactorOptions& fit, double from = 0,
                 double to = everywhere, FirstPoint first = FirstPoint::left_out);
// The same by the averaging of AnalysisOptions::loss, for the numbers "from" and "to" of the measure's call.
Curve loss_curve(const Asked& asked, const Run& run, LossOrdinate which,
                 FirstPoint first = FirstPoint::left_out);

// Return the slope of y against x, and of ln y against ln x, by least squares. NaN for fewer than two points.
double slope(const Curve& curve);
double log_slope(Curve curve);

// Divides [from, to] into bins of equal width in ln x. Returns for each bin in which every curve has a point,
// from small x to large, the mean ordinate of each curve.
std::vector<std::vector<double>> bin_means(const std::vector<Curve>& curves, double from, double to,
                                           int bins);
// Returns how far the curves lie apart in each of these bins, in percent: (largest - least)/mean of their
// mean ordinates.
std::vector<double> spreads_percent(const std::vector<Curve>& curves, double from, double to, int bins);

// Return the mean, and the largest, of the values. NaN if there is none.
inline double mean(const std::vector<double>& values) {
  double sum = 0;
  for (const double value : values) sum += value;
  return sum / static_cast<double>(values.size());
}
inline double most(const std::vector<double>& values) {
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : *std::ranges::max_element(values);
}

// Return what the run recorded, or throw std::invalid_argument.
inline const HalfCycles& half_cycles_of(const Run& run) {
  if (!run.half_cycles) throw std::invalid_argument("half_cycles: the run did not record them");
  return *run.half_cycles;
}

inline const Impacts& impacts_of(const Run& run) {
  if (!run.impacts) throw std::invalid_argument("impacts: the run did not record them");
  return *run.impacts;
}

// The parts of the table, by subject.
std::vector<Measure> loss_measures();       // loss factor curves
std::vector<Measure> damper_measures();     // several dampers
std::vector<Measure> component_measures();  // friction, weight and drag
std::vector<Measure> regime_measures();     // bounce-down, regular impacts, impact failure, phases of impacts
std::vector<Measure> model_measures();      // engines and settings compared, errors of the paper's formulas
std::vector<Measure> steady_measures();     // steady motions under a force

}  // namespace impact_damper
