// From the samples of a measured decay to the amplitudes of its half cycles (docs/mathematics.md, chapter
// 16).
#pragma once

#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "impact_damper/measured/record.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Thresholds of the reduction.
struct ReductionOptions {
  double half_window = std::numbers::pi / 4;  // of the fit to a peak, in radians of the oscillation
  double least_covered = 0.75;                // a window must have so many of the samples that fit into it
  double least_curvature = 0.5;  // a peak is flat, clipped, below this part of a sinusoid's curvature
  double outlier = 5;            // studentised by the others of the window: then a sample is left out
  double noise_multiple = 5;     // the decay ends where its amplitude is first below so many times the noise
  std::size_t least_window = 5;  // samples in a window
  std::size_t least_half_cycles = 12;  // or there is no decay
};

// The half cycles that count, in the order of time, and what was left out.
struct Reduction {
  std::vector<double> time;              // of the peaks, s
  std::vector<double> amplitude;         // of the displacement, mm
  std::vector<double> error;             // standard error of `amplitude` by the noise, mm
  std::vector<std::int64_t> half_cycle;  // number of the half cycle, those between counted, from 0
  double frequency = 0;                  // Hz, mean over these half cycles
  double noise = 0;          // standard deviation of a sample, mm or mm/s^2: what is no sinusoid in a window
  double offset = 0;         // mean of the middle line about which the mass swings, mm or mm/s^2
  double drift = 0;          // largest minus smallest value of the middle line
  double duration = 0;       // of the record, s
  double sampling_rate = 0;  // Hz, of the median step
  std::int64_t samples = 0;
  // Half cycles left out, by reason, before the decay ends in the noise.
  std::int64_t clipped = 0;  // the same largest or smallest value again and again, or a flat top
  std::int64_t in_gaps = 0;  // samples are missing, the two ends of the record included
  std::int64_t unclear = 0;  // no single peak, or no middle line
  bool ends_in_noise = false;
};

// Throws InputError, naming `name`, if there are fewer than least_samples samples (record.hpp), fewer than
// least_half_cycles half cycles that count, or too few samples in each.
Reduction reduced(const std::string& name, const MeasuredRecord& record,
                  const ReductionOptions& options = {});

// The amplitudes divided by `length` mm, the times by `time` s: rows for local_loss_factor (M12.1). Zero
// crossings and impacts are not known.
HalfCycles half_cycles_of(const Reduction& reduction, double length, double time);

// The peaks that the same fit finds in a simulated free decay with x0 > 0 and until_time: an impact near a
// peak moves both alike. Row 0, which is less than a half cycle, is left out. The fit is made of at most
// most_samples samples; later peaks are the engine's own. Throws InvalidArguments without until_time.
HalfCycles simulated_half_cycles(const Scene& scene, const Engine& engine,
                                 const ReductionOptions& options = {});

}  // namespace impact_damper
