// The step budget of a closed-form run. Where a motion is so stiff, or so long, that its bounds hold only for
// a very short time, the search for its next event would otherwise not end.
#pragma once

#include <cstdint>
#include <limits>

namespace impact_damper {

// Steps of searches (root_isolation.hpp) and panels of quadratures (energy.hpp) that this thread may still
// take, at about a microsecond each; simulate() sets them for each run.
inline thread_local constinit std::int64_t effort_left = std::numeric_limits<std::int64_t>::max();

// Sets it for as long as it lives.
class Effort {
 public:
  explicit Effort(std::int64_t steps) : before_(effort_left) { effort_left = steps; }
  ~Effort() { effort_left = before_; }
  Effort(const Effort&) = delete;
  Effort& operator=(const Effort&) = delete;

 private:
  std::int64_t before_;
};

// Takes one. False: none is left, and the search finds nothing; the run then ends where it has come to, by
// StopReason::step_budget (run_tracker.hpp).
inline bool spend_effort() { return effort_left-- > 0; }
inline bool out_of_effort() { return effort_left < 0; }

}  // namespace impact_damper
