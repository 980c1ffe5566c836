// Amplitudes of the half cycles of a measured decay, from its samples (docs/mathematics.md, chapter 16).
#pragma once

#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "application/measured/record.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Thresholds of the reduction.
struct ReductionOptions {
  double half_window = std::numbers::pi / 4;  // half width of a fit's window, rad of the oscillation
  double least_covered = 0.75;                // samples in a window divided by those that fit into it
  double least_curvature = 0.5;  // below this fraction of a sinusoid's curvature a peak is flat: clipped
  double outlier = 5;            // a sample with a larger residual, studentised by the others, is left out
  double noise_multiple = 5;     // the decay ends at the first amplitude below this multiple of the noise
  std::size_t least_window = 5;  // least number of samples in a window
  std::size_t least_half_cycles = 12;  // least number of half cycles in a decay
};

// The half cycles that are used, in the order of time, and how many were left out.
struct Reduction {
  std::vector<double> time;              // of the peaks, s
  std::vector<double> amplitude;         // of the displacement, mm
  std::vector<double> error;             // standard error of `amplitude` by the noise, mm
  std::vector<std::int64_t> half_cycle;  // number of the half cycle from 0; those left out count, too
  double frequency = 0;                  // Hz, mean over these half cycles
  double noise = 0;          // standard deviation of a sample about the fitted sinusoids, mm or mm/s^2
  double offset = 0;         // mean of the middle line about which the mass swings, mm or mm/s^2
  double drift = 0;          // largest minus smallest value of the middle line
  double duration = 0;       // of the record, s
  double sampling_rate = 0;  // Hz, 1 / the median step
  std::int64_t samples = 0;
  // Half cycles left out, by reason, before the decay ends in the noise.
  std::int64_t clipped = 0;  // the record's largest or smallest value repeated, or a flat top
  std::int64_t in_gaps = 0;  // samples are missing, or it lies at an end of the record
  std::int64_t unclear = 0;  // no single peak, or no middle line
  bool ends_in_noise = false;
};

// Returns the half cycles of a record. Throws InputError, naming `name`, if there are fewer than
// least_samples samples (record.hpp), fewer than least_half_cycles half cycles that are used, or too few
// samples in each.
Reduction reduced(const std::string& name, const MeasuredRecord& record,
                  const ReductionOptions& options = {});

// Returns the peaks as rows for local_loss_factor (M12.1): amplitudes in units of `length` mm, times in units
// of `time` s. Columns of zero crossings and impacts stay empty.
HalfCycles half_cycles_of(const Reduction& reduction, double length, double time);

// Simulates a free decay with x0 > 0 and returns its peaks by the fit used for records, so that an impact
// near a peak has the same effect on both. Row 0, which is less than a half cycle, is left out. At most
// most_samples samples are fitted; later peaks are the engine's own. Throws InvalidArguments without
// until_time.
HalfCycles simulated_half_cycles(const Scene& scene, const Engine& engine,
                                 const ReductionOptions& options = {});

}  // namespace impact_damper
