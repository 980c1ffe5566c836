// The steady motions of a scene over the frequency of its force, as a page about it shows them: with the
// frequency rising, and falling again (steady/sweep.hpp). Dimensionless, as in run.hpp; the choice of
// frequencies, and when two motions count as different, are in docs/mathematics.md, chapter 12.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/steady/steady_state.hpp"

namespace impact_damper {

// The motion at one frequency, reached with the frequency rising or falling.
struct ArrivedMotion {
  SteadyState steady;  // without means if a budget of the engine has ended it
  // For a motion that is not periodic and was followed twice in succession: its amplitude the first time.
  std::optional<double> earlier_amplitude;

  bool is_known() const { return steady.means.has_value(); }
  bool is_periodic() const { return steady.period.has_value(); }
  double amplitude() const { return steady.means->amplitude; }  // largest |x|; only if known
  // Whether it is neither periodic nor steady: the power of the force differs from the power lost (M12.9), or
  // the two amplitudes differ by more than their scatter (M12.8).
  bool changes() const;
};

struct ResponsePoint {
  double frequency = 0;
  ArrivedMotion rising, falling;

  // Whether both are known, neither changes, and their amplitudes differ (M12.8).
  bool has_two_motions() const;
};

// A point in one of the two ways.
struct LargestAmplitude {
  std::size_t point = 0;  // of ForcedResponse::points
  double frequency = 0;
  ArrivedMotion motion;
};

// Adjacent points, both included.
struct PointRange {
  std::size_t first = 0, last = 0;
};

struct ForcedResponse {
  SteadyRule rule;                    // by which each motion was followed
  std::vector<ResponsePoint> points;  // frequencies ascending, the scene's own among them
  std::size_t given = 0;              // the point of the scene's own frequency

  bool empty() const { return points.empty(); }
  // Returns the largest over all frequencies, in one way; absent if no motion is known.
  std::optional<LargestAmplitude> largest(ArrivedMotion ResponsePoint::*way) const;
  std::optional<LargestAmplitude> largest() const;  // in either way
  std::vector<PointRange> two_motions() const;      // where there are two, in ascending order
};

// Returns the response of the scene at some 60 frequencies, closest near the resonances of the empty box and
// of the locked mass, with more about the largest amplitude. The way up begins with the scene's release at
// the lowest frequency. The scene must have a force; the engine is exact or restitution (problems_of).
// `progress` is called with the number of motions that are done. The result is the same for all `threads`.
ForcedResponse forced_response(const Scene& scene, const Engine& engine, const Threads& threads,
                               const std::function<void(std::int64_t done)>& progress);

}  // namespace impact_damper
