// The amplitudes of a measured decay's half cycles (docs/mathematics.md, chapter 16).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "application/measured/record.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// Samples or half cycles in a row: from `first` to the one before `end`.
struct IndexRange {
  std::size_t first = 0, end = 0;
  std::size_t size() const { return end - first; }
};

// The half cycles that are used, in the order of time, and how many were left out.
struct Reduction {
  std::vector<double> time;              // of the peaks, s
  std::vector<double> amplitude;         // of the displacement, mm
  std::vector<double> error;             // standard error of `amplitude` by the noise, mm
  std::vector<std::int64_t> half_cycle;  // number of the half cycle from 0; those left out count, too
  double frequency = 0;                  // Hz, mean over these half cycles
  double noise = 0;     // standard deviation of a sample about the fitted sinusoids, mm; of a velocity or an
                        // acceleration that of an amplitude by its noise
  double offset = 0;    // mean of the middle line about which the mass swings, mm
  double drift = 0;     // largest minus smallest value of the middle line
  double duration = 0;  // of the record, s
  double sampling_rate = 0;  // Hz, 1 / the median step
  std::int64_t samples = 0;
  // Half cycles left out, by reason, before the decay ends in the noise.
  std::int64_t clipped = 0;  // the record's largest or smallest value repeated, or a flat top
  std::int64_t in_gaps = 0;  // samples are missing, or it lies at an end of the record
  std::int64_t unclear = 0;  // no single peak, or no middle line
  bool ends_in_noise = false;
  // The half cycles outside the decay that is used, with their amplitudes in mm by the mean frequency, and a
  // sentence for each reason why there are any: "Before 2.1 s the amplitude rises, by a factor of 4."
  std::vector<double> other_time, other_amplitude;
  std::vector<std::string> outside;
};

// Returns the half cycles of a record's decay: of the part in which the amplitude falls by the largest
// factor. Equal values one after the other for half a half cycle count as missing. frequency: Hz, > 0, about
// that of the oscillation, from which velocities and accelerations are integrated (M16.4). Throws InputError,
// naming `name`, if there are fewer than least_samples samples, fewer than 12 half cycles that are used, or
// too few samples in each.
Reduction reduced(const std::string& name, const MeasuredRecord& record, double frequency);

// Simulates a free decay with x0 > 0 and returns its peaks by the fit used for records, so that an impact
// near a peak has the same effect on both. Row 0, which is less than a half cycle, is left out. At most
// most_samples samples are fitted; later peaks are the engine's own. Throws InvalidArguments without
// until_time.
HalfCycles simulated_half_cycles(const Scene& scene, const Engine& engine);

}  // namespace impact_damper
