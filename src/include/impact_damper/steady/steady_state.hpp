// The steady state of a scene under its force, by simulating one period of the force after another
// (docs/mathematics.md, chapter 14).
//
// The state at phase 0 of the force is all that the next period depends on. Each period is a run of its own
// that begins where the one before ended, at time 0, so the phase has no error that grows with time. A motion
// is periodic if that state repeats; what then is missing to the periodic motion is estimated from how the
// differences have shrunk. Quantities are dimensionless, as in run.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/engines/recorder.hpp"
#include "impact_damper/motion/state.hpp"
#include "impact_damper/run.hpp"

namespace impact_damper {

// The state of a scene: x, x', and y and y' of each damper, by number in the scene.
struct SceneState {
  double x = 0, v = 0;
  std::vector<PlaceInCavity> dampers = {{0, 0}};

  SceneState() = default;
  SceneState(double of_x, double of_v, double of_y, double of_w)  // of one damper
      : x(of_x), v(of_v), dampers{{of_y, of_w}} {}
  // A state of one damper is a state of a scene.
  // NOLINTNEXTLINE(google-explicit-constructor)
  SceneState(const State<double>& one)  // cppcheck-suppress noExplicitConstructor
      : SceneState(one.x, one.v, one.y, one.w) {}
};

// The criteria by which a motion counts as steady.
struct SteadyRule {
  // Largest estimated distance of the state from the periodic motion, in units of the larger of the clearance
  // and the largest number of the state. In (0, 1e-2].
  double tolerance = 1e-10;
  std::int64_t longest_period = 16;  // in periods of the force, 1 to 64
  // Periods of the force after which a motion that has not repeated counts as not periodic. 1 to 1e9.
  std::int64_t max_periods = 5000;
  // Number of periods over which a motion that is not periodic is averaged, in ten blocks. 10 to 1e6.
  std::int64_t mean_periods = 500;
};
// Valid ranges of its whole numbers.
inline constexpr NumberRange longest_periods = within(1, 64), most_periods = within(1, 1e9),
                             mean_periods = within(10, 1e6);
// The problems of a rule, one for each member that is not valid.
std::vector<Problem> problems_of(const SteadyRule& rule);

// Impacts on the left and on the right wall.
using ImpactCounts = std::array<std::int64_t, 2>;

// Averages over whole periods of the force.
struct SteadyMeans {
  double amplitude = 0;  // largest |x|; without a period, in the half cycles that are complete in a block
  // The component of x at the force's frequency is fundamental * sin(omega_f t - lag), 0 <= fundamental,
  // -180 < lag <= 180 degrees (M14.4). A negative force_amplitude counts as a force of half a turn later.
  double fundamental = 0, lag_deg = 0;
  double power = 0;          // work of the force per unit of time
  double viscous_power = 0;  // taken out by the damper of the primary mass
  double impact_power = 0;   // taken out by impacts and contacts, and by friction and drag in the cavities
};

struct SteadyState {
  // StopReason::time, unless a budget of the engine has ended a run: then the point has no means.
  StopReason stop_reason = StopReason::time;
  std::optional<std::int64_t> period;  // m in periods of the force; absent: not periodic
  std::int64_t transient_periods = 0;  // until that was known
  // Factor by which the distance to the periodic motion shrinks in m periods; absent: it repeats to rounding.
  std::optional<double> contraction;
  std::int64_t measured_periods = 0;            // m, or SteadyRule::mean_periods
  ImpactCounts impacts{};                       // in the measured periods
  std::vector<ImpactCounts> impacts_by_damper;  // the same for each damper
  bool symmetric = false;  // it is its own mirror image half of an odd number of periods later
  std::optional<SteadyMeans> means;
  // Standard deviation of the ten blocks of a motion that is not periodic.
  double amplitude_scatter = 0, power_scatter = 0;
  SceneState state{};  // at phase 0, at the end
};

// Whether two amplitudes belong to different motions: they differ by more than visible_difference of the
// larger one, and by more than three standard deviations, given their scatter (M12.8).
inline constexpr double visible_difference = 0.05;
bool amplitudes_differ(double a, double scatter_a, double b, double scatter_b);

// Whether the force puts in what the damper and impacts take out, to 20 percent (M12.9); absent without
// means. A motion that is not periodic and not balanced either is still growing or decaying.
std::optional<bool> is_balanced(const SteadyState& steady);

// Why a scene cannot be followed from period to period: it has no force, it (except for its stops) or the
// engine is not valid, or the engine is the component element method, whose steps would begin anew with each
// run.
std::vector<Problem> problems_of(const Scene& scene, const Engine& engine);

// A run in its motions and events, from which its derivative follows (orbits/variational_equations.hpp).
struct RecordedRun {
  StopReason stop_reason = StopReason::time;
  double end_time = 0;
  SceneState begin{}, end{};  // end: before any event at that instant; only if the run ended by its time
  MotionChain chain;
};

// A scene and an engine, with all that does not depend on the state computed once. It may be copied, and used
// by several threads at a time.
class ForcedScene {
 public:
  // Throws InvalidArguments if problems_of(scene, engine) finds any; NumericalError if this process's
  // arithmetic is not IEEE 754's (floating_point.hpp).
  ForcedScene(const Scene& scene, const Engine& engine);

  // Simulates from a state at phase 0 until the motion is steady by `rule`, and measures it.
  SteadyState settle(const SceneState& state, const SteadyRule& rule) const;
  // The simulation without the measurement. Ends without a period as soon as enough(state) is true of the
  // state at phase 0, the first one included.
  SteadyState follow(const SceneState& state, const SteadyRule& rule,
                     const std::function<bool(const SceneState&)>& enough) const;
  // The measurement alone, of a motion that follow() has found.
  void measure(SteadyState& steady, const SteadyRule& rule) const;

  static constexpr std::size_t periods_at_once = 8;
  // The result of a run of some periods of the force. The functions that make such a run return it, or the
  // budget that ended the run before.
  struct Watched {
    std::array<SceneState, periods_at_once> states{};  // after each period, or half way and at the end
    ImpactCounts impacts{}, impacts_until_half_way{};
    std::vector<ImpactCounts> by_damper, by_damper_until_half_way;  // for each damper
    double amplitude = 0;                                           // of the half cycles that are complete
    EnergyBalance energy;
  };
  // The states at phase 0 after each of the next periods_at_once periods, and nothing else. One run for
  // several periods cuts fewer flights in two than one for each.
  Expected<Watched, StopReason> pass_periods(const SceneState& state) const;
  // All of Watched, with the states half way and at the end, after `periods` periods.
  Expected<Watched, StopReason> watch(const SceneState& state, std::int64_t periods) const;
  // Records the run from a state at phase 0 until the time `until`, or until a budget of the engine ends it.
  RecordedRun record(const SceneState& state, double until) const;
  double period() const { return period_; }  // of the force, 2 pi / omega_f

 private:
  Scene released(const SceneState& state, double until) const;
  // Runs `periods` periods of the force. `states`: how many equally spaced ones are kept, the last at the
  // end.
  Expected<Watched, StopReason> run_from(const SceneState& state, std::int64_t periods, std::int64_t states,
                                         bool measures) const;
  SteadyMeans means_of(const Watched& watched, const SceneState& begin, std::int64_t periods) const;
  void measure_periodic(SteadyState& steady, const SteadyRule& rule) const;
  void measure_blocks(SteadyState& steady, const SteadyRule& rule) const;

  Scene scene_;
  Engine engine_;
  double period_ = 0;   // of the force, 2 pi / omega_f
  bool rigid_ = false;  // rigid walls: a state must lie between them
  std::function<Outcome(const Scene&, Recorder&)> run_;
};

// The state in a row of a history.
SceneState state_in(const History& history, std::size_t row);
// A scene's initial state, and the scene with another one, in which numbers with is_too_small() become 0.
SceneState release_of(const Scene& scene);
Scene released_from(Scene scene, const SceneState& state);

// Whether the mirror image of each motion, half a period of the force later, is a motion: without weight.
bool has_mirror(const Scene& scene);
// The mirror image of a state of the scene: left and right exchanged.
SceneState mirrored(const SceneState& s, const Scene& scene);
// The largest difference of two states' components.
double distance(const SceneState& a, const SceneState& b);
// The larger of 1 and the largest component of a state.
double size_of(const SceneState& s);

// Finds the smallest number of periods after which states repeat (M14.1, M14.2).
class Recurrence {
 public:
  explicit Recurrence(const SteadyRule& rule);

  struct Repeats {
    std::int64_t period;
    std::optional<double> contraction;
  };
  // Adds the next state at phase 0. Returns the period and the contraction if it repeats earlier states.
  std::optional<Repeats> add(const SceneState& state);

 private:
  static constexpr std::int64_t differences = 8;  // between successive repeats, that are compared
  const SceneState& before(std::int64_t periods) const;

  double tolerance_;
  std::int64_t longest_, count_ = 0;
  std::vector<SceneState> states_;  // the last ones, as a ring buffer
  std::int64_t last_ = -1;          // the index of the latest
};

}  // namespace impact_damper
