#include "application/measured/reduction.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <utility>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/math/dense.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/simulate.hpp"

namespace impact_damper {

// --- Half cycles ------------------------------------------------------------------------------------------

namespace {

[[noreturn]] void reject(const std::string& name, const std::string& what) {
  throw InputError(name, {{"", what}});
}

constexpr double half_window = std::numbers::pi / 4;  // half width of a fit's window, rad of the oscillation
constexpr double least_covered = 0.75;                // samples in a window divided by those that fit into it
constexpr double least_curvature = 0.5;  // divided by a sinusoid's: below it a peak is flat, as if clipped
constexpr double outlier = 5;            // a sample with a larger studentised residual is left out
constexpr double end_in_noise = 5;       // the decay ends at the first amplitude below this multiple of it
constexpr std::size_t least_window = 5;  // samples in a window
constexpr std::size_t least_half_cycles = 12;     // in a decay
constexpr double to_standard_deviation = 1.4826;  // of a normal distribution, divided by its median deviation

double median_of(std::vector<double> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

std::vector<double> steps_of(const std::vector<double>& time) {
  std::vector<double> steps;
  for (std::size_t i = 1; i < time.size(); ++i) steps.push_back(time[i] - time[i - 1]);
  return steps;
}

// Returns the running median of five samples. A spike of an impact or a wrong sample is no extreme of it.
std::vector<double> without_spikes(const std::vector<double>& value) {
  std::vector<double> smooth = value;
  for (std::size_t i = 2; i + 2 < value.size(); ++i) {
    std::array<double, 5> five{value[i - 2], value[i - 1], value[i], value[i + 1], value[i + 2]};
    std::nth_element(five.begin(), five.begin() + 2, five.end());
    smooth[i] = five[2];
  }
  return smooth;
}

// Standard deviation of white noise on a smooth signal, from its third differences in the last quarter, where
// the signal is smallest: those of white noise have the variance 20 sigma^2.
double rough_noise(const std::vector<double>& value) {
  std::vector<double> differences;
  for (std::size_t i = value.size() * 3 / 4; i + 3 < value.size(); ++i)
    differences.push_back(std::abs(value[i + 3] - 3 * value[i + 2] + 3 * value[i + 1] - value[i]));
  return to_standard_deviation * median_of(std::move(differences)) / std::sqrt(20.0);
}

struct Extreme {
  std::size_t index = 0;
  bool is_maximum = false;
};

// Returns maxima and minima in alternation. An extreme counts once the signal has returned from it by half of
// its distance from the previous extreme, and by more than `least`. If it has not within the mean time
// between the last few, as after a gap, the search begins anew.
std::vector<Extreme> extremes_of(const std::vector<double>& time, const std::vector<double>& value,
                                 double least) {
  constexpr std::size_t few = 5;
  constexpr double look_ahead = 3;  // half cycles
  std::vector<Extreme> extremes;
  const auto half_cycle = [&]() -> std::optional<double> {
    if (extremes.size() <= few) return std::nullopt;
    return (time[extremes.back().index] - time[extremes[extremes.size() - 1 - few].index]) / double(few);
  };
  std::size_t low = 0, high = 0;
  int direction = 0;
  double threshold = 0;
  const auto begin = [&](std::size_t from) {
    low = high = from;
    direction = 0;
    double smallest = value[from], largest = value[from];
    const auto known = half_cycle();
    for (std::size_t i = from; i < time.size() && !(known && time[i] > time[from] + look_ahead * *known); ++i)
      smallest = std::min(smallest, value[i]), largest = std::max(largest, value[i]);
    threshold = std::max(least, (largest - smallest) / 4);
  };
  begin(0);
  for (std::size_t i = 0; i < value.size(); ++i) {
    const auto known = half_cycle();
    const std::size_t candidate = direction >= 0 ? high : low;
    if (direction != 0 && known && time[i] - time[candidate] > *known) begin(i);
    if (direction >= 0 && value[i] > value[high]) high = i;
    if (direction <= 0 && value[i] < value[low]) low = i;
    if (direction != 0) threshold = std::max(least, std::abs(value[high] - value[low]) / 2);
    if (direction >= 0 && value[high] - value[i] > threshold) {
      extremes.push_back({high, true});
      direction = -1;
      low = i;
    } else if (direction <= 0 && value[i] - value[low] > threshold) {
      extremes.push_back({low, false});
      direction = 1;
      high = i;
    }
  }
  return extremes;
}

// Sinusoid of given angular frequency about a free level, fitted near a peak (M16.1).
struct PeakFit {
  double time = 0, value = 0;
  double curvature = 0;         // a: amplitude of the sinusoid, negative at a minimum
  double value_factor = 0;      // standard error of `value`, divided by that of a sample
  double curvature_factor = 0;  // standard error of `curvature`, divided likewise
  double variance = 0;          // of the samples about the sinusoid
  bool is_covered = false, is_single = false;
};

using Normal = SolutionAndInverse<3>;  // of the normal equations
// Returns b^T m^-1 b: the leverage of a sample with the basis b.
double leverage(const Normal& normal, const std::array<double, 3>& b) {
  double sum = 0;
  for (std::size_t j = 0; j < 3; ++j)
    for (std::size_t k = 0; k < 3; ++k) sum += b[j] * normal.inverse[j][k] * b[k];
  return sum;
}

struct Samples {
  std::span<const double> time, value;
  double step = 0;  // the median
};

// Returns the range of those of ascending times that are within `reach` of `centre`.
IndexRange range_about(std::span<const double> time, double centre, double reach) {
  return {std::size_t(std::ranges::lower_bound(time, centre - reach) - time.begin()),
          std::size_t(std::ranges::upper_bound(time, centre + reach) - time.begin())};
}

PeakFit fitted_peak(const Samples& samples, double centre, double omega, bool is_maximum,
                    bool removes_outliers = true) {
  constexpr int rounds = 5;  // at most, to move the centre to the peak
  PeakFit peak;
  peak.time = centre;
  const double reach = half_window / omega, sign = is_maximum ? 1 : -1;
  for (int round = 0; round < rounds; ++round) {
    const auto [first, end] = range_about(samples.time, peak.time, reach);
    const std::size_t count = end - first;
    const double expected = 2 * reach / samples.step;
    peak.is_covered = count >= least_window && double(count) >= least_covered * std::floor(expected) &&
                      first > 0 && end < samples.time.size();
    if (!peak.is_covered) return peak;
    std::vector<std::array<double, 3>> basis(count);
    for (std::size_t i = 0; i < count; ++i) {
      const auto [sin, cos] = sin_cos(omega * (samples.time[first + i] - peak.time));
      basis[i] = {1, cos - 1, sin};
    }
    std::vector<double> residual(count, 0.0);
    std::vector<bool> used(count, true);
    std::optional<Normal> solution;
    std::size_t left = count;
    for (const std::size_t least_left = count - count / 4;;) {
      std::array<std::array<double, 3>, 3> m{};
      std::array<double, 3> r{};
      for (std::size_t i = 0; i < count; ++i) {
        if (!used[i]) continue;
        for (std::size_t j = 0; j < 3; ++j) {
          for (std::size_t k = 0; k < 3; ++k) m[j][k] += basis[i][j] * basis[i][k];
          r[j] += basis[i][j] * samples.value[first + i];
        }
      }
      solution = solution_and_inverse(m, r, 1e-12);
      if (!solution) return peak;
      double sum = 0;
      for (std::size_t i = 0; i < count; ++i) {
        residual[i] = samples.value[first + i];
        for (std::size_t j = 0; j < 3; ++j) residual[i] -= solution->x[j] * basis[i][j];
        if (used[i]) sum += residual[i] * residual[i];
      }
      peak.variance = left > 3 ? sum / double(left - 3) : 0;
      constexpr std::size_t enough = 8;  // with fewer the variance of the others is too uncertain
      if (!removes_outliers || left < enough || left == least_left) break;
      // The sample whose removal leaves the least sum of squared residuals.
      double worst = 0;
      std::size_t at = count;
      for (std::size_t i = 0; i < count; ++i) {
        if (!used[i]) continue;
        const double share = residual[i] * residual[i] / (1 - leverage(*solution, basis[i]));
        if (share > worst) worst = share, at = i;
      }
      // Squares of the studentised residual and of its limit, times the variance of the others.
      if (at == count || worst <= outlier * outlier * (sum - worst) / double(left - 4)) break;
      used[at] = false;
      --left;
    }
    const auto [level, a, b] = solution->x;
    const double amplitude = std::sqrt(a * a + b * b);
    peak.value = level - a + sign * amplitude;
    peak.curvature = a;
    peak.value_factor = std::sqrt(solution->inverse[0][0]);
    peak.curvature_factor = std::sqrt(solution->inverse[1][1]);
    const double phase = a * sign > 0 ? angle_of(b * sign, a * sign) : 0;
    peak.is_single = a * sign > 0 && std::abs(phase) <= half_window;
    constexpr double close = 1e-6;
    if (!peak.is_single || std::abs(phase) < close || round + 1 == rounds) break;
    peak.time += phase / omega;
  }
  return peak;
}

// Samples clipped at the record's largest or smallest value, which stands twice in a row at two places at
// least.
class Limits {
 public:
  explicit Limits(const std::vector<double>& value) {
    const auto [low, high] = std::ranges::minmax(value);
    at_limit_.resize(value.size());
    for (const double limit : {low, high}) {
      constexpr std::size_t long_row = 2;
      std::vector<std::size_t> ends;  // of rows at this limit
      for (std::size_t i = 0, row = 0; i < value.size(); ++i) {
        row = value[i] == limit ? row + 1 : 0;
        if (row == long_row) ends.push_back(i);
      }
      if (ends.size() < 2) continue;  // one row may be the largest peak in coarse steps
      for (std::size_t i = 0; i < value.size(); ++i)
        if (value[i] == limit) at_limit_[i] = true;
    }
  }
  bool any(const IndexRange& range) const {
    const auto begin = at_limit_.begin();
    return std::count(begin + std::ptrdiff_t(range.first), begin + std::ptrdiff_t(range.end), true) > 0;
  }

 private:
  std::vector<bool> at_limit_;
};

enum class Kind { good, clipped, in_gap, unclear };
struct Candidate {
  PeakFit fit;
  bool is_maximum = false;
  Kind kind = Kind::good;
  double half_cycle = 0;  // duration near it, s
  double middle = 0;      // of the line about which the mass swings (M16.2)
  double amplitude = 0;   // of the measured quantity
  std::int64_t number = 0;
};

// Marks as clipped all peaks that reach the height of two or more flat ones at the top of all maxima, or of
// all minima: the instrument has a limit there.
void drop_below_limit(std::vector<Candidate>& all, double noise) {
  constexpr double noise_multiple = 5, part_of_range = 0.03;  // the fit overshoots a cut top
  double low = all[0].fit.value, high = low;
  for (const Candidate& each : all)
    low = std::min(low, each.fit.value), high = std::max(high, each.fit.value);
  const double tolerance = noise_multiple * noise + part_of_range * (high - low);
  for (const bool is_maximum : {false, true}) {
    const auto reaches = [&](const Candidate& each) {
      return each.is_maximum == is_maximum && each.kind != Kind::in_gap &&
             (is_maximum ? each.fit.value >= high - tolerance : each.fit.value <= low + tolerance);
    };
    const auto flat = std::ranges::count_if(
        all, [&](const Candidate& each) { return reaches(each) && each.kind == Kind::clipped; });
    if (flat < 2) continue;
    for (Candidate& each : all)
      if (reaches(each)) each.kind = Kind::clipped;
  }
}

bool are_neighbours(const Candidate& a, const Candidate& b) {
  constexpr double tolerance = 0.25;
  return a.is_maximum != b.is_maximum && std::abs((b.fit.time - a.fit.time) / a.half_cycle - 1) < tolerance;
}

// Finds the middle line by (M16.2), and from it the amplitudes. A candidate becomes unclear if the line is
// known nowhere near it.
void find_middle_line(std::span<Candidate> all) {
  constexpr double reach = 6;  // half cycles to either side
  constexpr std::size_t least_line = 5;
  std::vector<double> time, middle;
  std::vector<std::size_t> good;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].kind == Kind::good) good.push_back(i);
  for (std::size_t i = 1; i + 1 < good.size(); ++i) {
    const Candidate &before = all[good[i - 1]], &here = all[good[i]], &after = all[good[i + 1]];
    if (!are_neighbours(before, here) || !are_neighbours(here, after)) continue;
    time.push_back(here.fit.time);
    middle.push_back((before.fit.value + 2 * here.fit.value + after.fit.value) / 4);
  }
  for (const std::size_t index : good) {
    Candidate& here = all[index];
    const auto [first, end] = range_about(time, here.fit.time, reach * here.half_cycle);
    if (first == end) {
      here.kind = Kind::unclear;
      continue;
    }
    const double count = double(end - first);
    double mean_time = 0, mean = 0, squares = 0, products = 0;
    for (std::size_t i = first; i < end; ++i)
      mean_time += (time[i] - here.fit.time) / count, mean += middle[i] / count;
    for (std::size_t i = first; i < end; ++i) {
      const double t = time[i] - here.fit.time - mean_time;
      squares += t * t;
      products += t * (middle[i] - mean);
    }
    here.middle = mean - (end - first >= least_line ? products / squares * mean_time : 0);
    here.amplitude = std::abs(here.fit.value - here.middle);
  }
}

constexpr double rise = 1.25;  // a larger one is none of noise and impacts

// A part of the record in which the amplitude falls: half cycles `first` to the one before `end`. Before that
// it may rise, from `begin` on.
struct Fall {
  std::size_t begin = 0, first = 0, end = 0;
  double factor = 1;  // by which the amplitude falls
};
// Divides half cycles into falls. One ends at its least amplitude if two after it are larger, by a quarter
// and by more than `least`, the noise, than all of the ten before it: somebody has struck the structure
// again. A loose mass gives back no more than it has taken in the last few. Amplitudes below `least` count as
// that.
std::vector<Fall> falls_of(const std::vector<Candidate>& all, const std::vector<std::size_t>& good,
                           double least) {
  constexpr std::size_t few = 10;
  const auto amplitude = [&](std::size_t i) { return std::max(all[good[i]].amplitude, least); };
  std::vector<Fall> falls;
  std::size_t begin = 0, top = 0, bottom = 0;
  const auto close = [&](std::size_t next) {
    falls.push_back({begin, top, bottom + 1, amplitude(top) / amplitude(bottom)});
    begin = top = bottom = next;
  };
  const auto is_above = [&](std::size_t i) {
    for (std::size_t k = std::max(top, bottom - std::min(bottom, few)); k <= bottom; ++k)
      if (!(amplitude(i) > rise * amplitude(k) + least)) return false;
    return true;
  };
  for (std::size_t i = 1; i < good.size(); ++i) {
    if (amplitude(i) > amplitude(top) && amplitude(top) < rise * amplitude(bottom)) {
      top = bottom = i;
    } else if (amplitude(i) < amplitude(bottom)) {
      bottom = i;
    } else if (is_above(i) && (i + 1 == good.size() || is_above(i + 1))) {
      close(bottom + 1);
      i = begin;
    }
  }
  if (!good.empty()) close(good.size());
  return falls;
}

// Returns the candidates of the decay: of all falls that by the largest factor. Adds a sentence on each part
// that is left out.
IndexRange find_decay(const std::vector<Candidate>& all, double least, std::vector<std::string>& outside) {
  std::vector<std::size_t> peaks;
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].kind == Kind::good) peaks.push_back(i);
  const std::vector<Fall> falls = falls_of(all, peaks, least);
  if (falls.empty()) return {0, all.size()};
  const auto chosen = std::size_t(std::ranges::max_element(falls, {}, &Fall::factor) - falls.begin());
  Fall decay = falls[chosen];
  if (decay.first > decay.begin) {
    // It rises before. Peaks that the instrument has cut are higher than those to either side of them.
    for (std::size_t i = decay.first + 1; i < decay.end; ++i)
      if (rise * all[peaks[i]].amplitude > all[peaks[decay.first]].amplitude &&
          std::any_of(all.begin() + std::ptrdiff_t(peaks[i - 1]), all.begin() + std::ptrdiff_t(peaks[i]),
                      [](const Candidate& each) { return each.kind == Kind::clipped; }))
        decay.first = i;
  }
  const bool rises = decay.first > decay.begin, follows = chosen > 0, goes_on = chosen + 1 < falls.size();
  const auto when = [&](std::size_t peak) { return rounded_text(all[peaks[peak]].fit.time, 3) + " s"; };
  const auto ratio = [&](std::size_t peak, std::size_t of) {
    return rounded_text(all[peaks[peak]].amplitude / all[peaks[of]].amplitude, 3);
  };
  if (follows)
    outside.push_back(filled("Before {} there is another decay, by a factor of {}: it is left out.",
                             when(decay.begin), rounded_text(falls[chosen - 1].factor, 3)));
  else if (rises)
    outside.push_back(filled("Until {} the amplitude rises, by a factor of {}: that is left out.",
                             when(decay.first), ratio(decay.first, decay.begin)));
  if (goes_on)
    outside.push_back(
        filled("Behind {} the amplitude rises again, by a factor of {}: what follows is left out.",
               when(decay.end - 1), ratio(falls[chosen + 1].first, decay.end - 1)));
  // A peak beside such a change may have part of it.
  return {rises || follows ? peaks[decay.first] + 1 : 0, goes_on ? peaks[decay.end - 1] : all.size()};
}

// Returns the record without rows of equal values that last for half a half cycle or longer, as an instrument
// writes them in place of samples that are missing, but for those at its limits; absent if it has none.
std::optional<MeasuredRecord> without_rows(const MeasuredRecord& record, double half_cycle, double until) {
  const auto [low, high] = std::ranges::minmax(record.value);
  MeasuredRecord kept = record;
  kept.time.clear(), kept.value.clear();
  for (std::size_t i = 0, next = 0; i < record.value.size(); i = next) {
    while (next < record.value.size() && record.value[next] == record.value[i]) ++next;
    const bool is_limit = record.value[i] == low || record.value[i] == high;
    if (!is_limit && record.time[i] < until && record.time[next - 1] - record.time[i] > half_cycle / 2)
      continue;
    for (std::size_t k = i; k < next; ++k)
      kept.time.push_back(record.time[k]), kept.value.push_back(record.value[k]);
  }
  if (kept.time.size() == record.time.size()) return std::nullopt;
  return kept;
}

// --- Displacements of velocities and accelerations --------------------------------------------------------

// Returns means of the samples in intervals of `step` s; the record itself if it has less than two in each.
MeasuredRecord in_blocks(const MeasuredRecord& record, double step) {
  if (!(2 * median_of(steps_of(record.time)) < step)) return record;
  MeasuredRecord means;
  means.quantity = record.quantity;
  const double begin = record.time.front();
  const auto block_of = [&](std::size_t i) { return std::floor((record.time[i] - begin) / step); };
  for (std::size_t i = 0, next = 0; i < record.time.size(); i = next) {
    double time = 0, value = 0;
    for (; next < record.time.size() && block_of(next) == block_of(i); ++next)
      time += record.time[next] - begin, value += record.value[next];
    means.time.push_back(begin + time / double(next - i));
    means.value.push_back(value / double(next - i));
  }
  return means;
}

// Returns the displacement less its weighted mean over two periods (M16.4), at all samples within a period of
// which none is missing.
MeasuredRecord integrated(const MeasuredRecord& record, double period) {
  constexpr double longest_step = 2.5;  // divided by the median: beyond it samples are missing
  const std::vector<double>&time = record.time, &value = record.value;
  const double step = median_of(steps_of(time));
  const bool twice = record.quantity == MeasuredQuantity::acceleration;
  MeasuredRecord result;
  std::size_t whole = 0, looked_at = 0;  // from `whole` up to `looked_at` no samples are missing
  for (std::size_t j = 1; j + 1 < time.size(); ++j) {
    const auto [first, end] = range_about(time, time[j], period);
    for (; looked_at < end && looked_at + 1 < time.size(); ++looked_at)
      if (time[looked_at + 1] - time[looked_at] > longest_step * step) whole = looked_at + 1;
    if (first == 0 || end == time.size() || whole >= first) continue;
    double sum = 0;
    for (std::size_t i = first; i < end; ++i) {
      const double t = time[i] - time[j], part = 1 - std::abs(t) / period;
      const double once = t == 0 ? 0 : std::copysign(part * part / 2, -t);
      sum += (twice ? -part * part * part * period / 6 : once) * value[i] * (time[i + 1] - time[i - 1]) / 2;
    }
    const double around = (time[j + 1] - time[j - 1]) / 2,
                 bend = twice ? value[j] : (value[j - 1] - value[j + 1]) / (2 * around);
    result.time.push_back(time[j]);
    result.value.push_back(sum + around * around / 12 * bend);
  }
  return result;
}

std::string as_missing(std::size_t samples) {
  return filled("{} samples have the value of the one before them for so long that they count as missing.",
                samples);
}

constexpr double above_noise = 5;
std::vector<Extreme> extremes_above_noise(const MeasuredRecord& record) {
  return extremes_of(record.time, without_spikes(record.value), above_noise * rough_noise(record.value));
}
void require_half_cycles(const std::string& name, std::size_t count, const std::string& others = "") {
  if (count < least_half_cycles)
    reject(name, filled("must hold a free decay of at least {} half cycles above the noise, got {}{}",
                        least_half_cycles, count, others));
}
std::vector<double> half_cycles_between(const std::vector<Extreme>& extremes,
                                        const std::vector<double>& time) {
  std::vector<double> intervals;
  for (std::size_t i = 1; i < extremes.size(); ++i)
    intervals.push_back(time[extremes[i].index] - time[extremes[i - 1].index]);
  return intervals;
}

// Reduces displacements. known_error: the standard error of an amplitude by the noise, if it does not follow
// from the samples about a peak.
Reduction reduced_displacement(const std::string& name, const MeasuredRecord& record,
                               std::optional<double> known_error) {
  Reduction result;
  const std::vector<double>&time = record.time, &value = record.value;
  require_samples(name, record);
  const double step = median_of(steps_of(time));
  result.samples = std::int64_t(time.size());
  result.duration = time.back() - time.front();
  result.sampling_rate = 1 / step;

  const std::vector<Extreme> extremes = extremes_above_noise(record);
  require_half_cycles(name, extremes.size());

  // A half cycle lasts as long as the median of those around it, which a gap or a false extreme hardly
  // changes.
  constexpr std::size_t around = 5;
  const std::vector<double> intervals = half_cycles_between(extremes, time);
  const auto local = [&](std::size_t i) {
    const std::size_t first = i < around ? 0 : i - around, last = std::min(i + around, intervals.size());
    return median_of({intervals.begin() + std::ptrdiff_t(first), intervals.begin() + std::ptrdiff_t(last)});
  };
  if (const auto kept = without_rows(record, median_of(intervals), time[extremes.back().index])) {
    result = reduced_displacement(name, *kept, known_error);
    result.outside.push_back(as_missing(time.size() - kept->time.size()));
    return result;
  }
  const double least_per_cycle = double(least_window) * half_turn<double>() / half_window;
  if (!(2 * median_of(intervals) / step >= least_per_cycle))
    reject(name, filled("must have at least {} samples in a cycle, got {}", std::ceil(least_per_cycle),
                        rounded_text(2 * median_of(intervals) / step, 3)));

  const Limits limits(value);
  const Samples samples{time, value, step};
  std::vector<Candidate> all;
  for (std::size_t i = 0; i < extremes.size(); ++i) {
    Candidate candidate;
    candidate.is_maximum = extremes[i].is_maximum;
    candidate.half_cycle = local(i);
    const double omega = half_turn<double>() / candidate.half_cycle, at = time[extremes[i].index];
    candidate.fit = fitted_peak(samples, at, omega, candidate.is_maximum);
    if (limits.any(range_about(time, at, half_window / omega))) {
      candidate.kind = Kind::clipped;
    } else if (!candidate.fit.is_covered) {
      candidate.kind = Kind::in_gap;
    }
    all.push_back(candidate);
  }
  std::vector<double> variances;
  for (const Candidate& each : all)
    if (each.kind == Kind::good) variances.push_back(each.fit.variance);
  result.noise = known_error.value_or(std::sqrt(median_of(std::move(variances))));

  for (std::size_t i = 0; i < all.size(); ++i) {
    Candidate& each = all[i];
    if (each.kind != Kind::good) continue;
    // The curvature of a sinusoid would be about half the distance from the neighbours.
    const double before = i > 0 ? value[extremes[i - 1].index] : value[extremes[i + 1].index],
                 after = i + 1 < all.size() ? value[extremes[i + 1].index] : before;
    const double swing = std::abs(value[extremes[i].index] - (before + after) / 2) / 2;
    const double curvature = each.is_maximum ? each.fit.curvature : -each.fit.curvature;
    if (curvature + 3 * result.noise * each.fit.curvature_factor < least_curvature * swing) {
      each.kind = Kind::clipped;
    } else if (!each.fit.is_single) {
      each.kind = Kind::unclear;
    }
  }
  drop_below_limit(all, result.noise);
  find_middle_line(all);

  const double least = end_in_noise * result.noise;
  const IndexRange used = find_decay(all, least, result.outside);
  if (!result.outside.empty()) find_middle_line(std::span(all).subspan(used.first, used.size()));

  // Numbers of the half cycles: those without a peak in between are counted by the time that has passed.
  std::vector<Candidate*> good;
  for (std::size_t i = used.first; i < used.end; ++i) {
    Candidate& each = all[i];
    if (each.kind == Kind::good) {
      if (each.amplitude < least) {
        result.ends_in_noise = true;
        break;
      }
      if (!good.empty()) {
        // Between a maximum and a minimum lies an odd number of half cycles.
        const double passed = (each.fit.time - good.back()->fit.time) / each.half_cycle;
        const bool is_odd = each.is_maximum != good.back()->is_maximum;
        each.number = good.back()->number +
                      (is_odd ? 2 * std::int64_t(std::floor(passed / 2)) + 1
                              : std::max<std::int64_t>(2, 2 * std::int64_t(std::floor((passed + 1) / 2))));
      }
      good.push_back(&each);
    }
    result.clipped += each.kind == Kind::clipped;
    result.in_gaps += each.kind == Kind::in_gap;
    result.unclear += each.kind == Kind::unclear;
  }
  require_half_cycles(name, good.size(),
                      filled(" ({} clipped or flat, {} at its ends or with samples missing, {} unclear)",
                             result.clipped, result.in_gaps, result.unclear));
  const double turns = double(good.back()->number - good.front()->number);
  result.frequency = turns / 2 / (good.back()->fit.time - good.front()->fit.time);
  // Adds the half cycles within gaps in which no extreme was found.
  result.in_gaps += std::max<std::int64_t>(0, good.back()->number + 1 - std::int64_t(good.size()) -
                                                  std::ranges::count_if(all, [&](const Candidate& each) {
                                                    return each.kind != Kind::good &&
                                                           each.fit.time > good.front()->fit.time &&
                                                           each.fit.time < good.back()->fit.time;
                                                  }));

  double lowest = good[0]->middle, highest = lowest;
  for (std::size_t i = 0; i < good.size(); ++i) {
    const Candidate& each = *good[i];
    lowest = std::min(lowest, each.middle), highest = std::max(highest, each.middle);
    result.offset += each.middle / double(good.size());
    result.time.push_back(each.fit.time);
    result.amplitude.push_back(each.amplitude);
    result.error.push_back(known_error.value_or(result.noise * each.fit.value_factor));  // (M16.3)
    result.half_cycle.push_back(each.number);
  }
  result.drift = highest - lowest;
  if (result.outside.empty()) return result;
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].kind != Kind::good || (i >= used.first && i < used.end)) continue;
    result.other_time.push_back(all[i].fit.time);
    result.other_amplitude.push_back(all[i].amplitude);
  }
  return result;
}

}  // namespace

Reduction reduced(const std::string& name, const MeasuredRecord& record, double frequency) {
  require_samples(name, record);
  if (record.quantity == MeasuredQuantity::displacement) return reduced_displacement(name, record, {});
  constexpr double blocks_in_period = 64, close = 0.01;
  constexpr int most_rounds = 6;
  double period = 1 / frequency;
  const auto whole = without_rows(record, period / 2, record.time.back());
  MeasuredRecord blocks, displacement;
  for (int round = 0; round < most_rounds; ++round) {
    blocks = in_blocks(whole ? *whole : record, period / blocks_in_period);
    displacement = integrated(blocks, period);
    const std::vector<Extreme> extremes = extremes_above_noise(displacement);
    require_half_cycles(name, extremes.size());
    const double found = 2 * median_of(half_cycles_between(extremes, displacement.time));
    if (std::abs(found / period - 1) < close) break;
    period = found;
  }
  const double step = median_of(steps_of(blocks.time)), noise = rough_noise(blocks.value);
  // (M16.10) divided by the noise.
  const double factor = record.quantity == MeasuredQuantity::velocity ? std::sqrt(period / 10)
                                                                      : std::sqrt(period / 126) * period;
  Reduction result = reduced_displacement(name, displacement, noise * std::sqrt(step) * factor);
  const std::vector<double>& time = record.time;
  result.samples = std::int64_t(time.size());
  result.duration = time.back() - time.front();
  result.sampling_rate = 1 / median_of(steps_of(time));
  if (whole) result.outside.push_back(as_missing(time.size() - whole->time.size()));
  return result;
}

HalfCycles simulated_half_cycles(const Scene& scene, const Engine& engine) {
  if (!scene.until_time) throw InvalidArguments(std::vector<Problem>{{"until_time", "must be given"}});
  constexpr double samples_per_cycle = 32;
  const double step = 2 * half_turn<double>() / samples_per_cycle;
  const double wanted = whole_above(std::min(*scene.until_time / step, double(most_samples - 1)));
  const std::int64_t count = std::max<std::int64_t>(2, std::int64_t(wanted));
  Record record;
  record.history.push_back({0, double(count - 1) * step, count});
  const Run run = simulate(scene, engine, record);
  const Samples samples{run.history->time, run.history->x, step};
  const HalfCycles& rows = *run.half_cycles;
  HalfCycles fitted;
  for (std::size_t i = 1; i < rows.peak_time.size(); ++i) {
    const std::size_t before = i - 1, after = std::min(i + 1, rows.peak_time.size() - 1);
    const double half_cycle = (rows.peak_time[after] - rows.peak_time[before]) / double(after - before);
    if (!(half_cycle > 0)) continue;
    const PeakFit peak =
        fitted_peak(samples, rows.peak_time[i], half_turn<double>() / half_cycle, i % 2 == 0, false);
    const bool is_valid = peak.is_covered && peak.is_single;
    fitted.peak_time.push_back(is_valid ? peak.time : rows.peak_time[i]);
    fitted.amplitude.push_back(is_valid ? std::abs(peak.value) : rows.amplitude[i]);
  }
  return fitted;
}

}  // namespace impact_damper
