// The three engines that can run a scene, each as the options that can change its result.
// The engines themselves: exact.hpp, restitution.hpp, cem.hpp; the one entry point to all three:
// simulate.hpp; what is allowed of each option, and what files and the command line call it:
// engine_options.hpp.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <variant>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/scene.hpp"

namespace impact_damper {

// The rule by which the wall's damping ratio zeta_m follows from the restitution e (motion/wall.hpp, M2.4).
enum class Calibration {
  fixed_wall,  // the paper's: an impact has the restitution e exactly if the primary mass is held still
  two_body,    // an impact has the restitution e exactly if both masses are otherwise free
};

// The velocity that the wall's damper of the component element method uses.
enum class Damper {
  centred,  // (y_{n+1} - y_{n-1}) / 2h: implicit in the new step, second order
  lagged,   // (y_n - y_{n-1}) / h: one step behind, explicit
};

// Limits that end a run if nothing else ends it before. Reaching one is a stop reason, not an error. With the
// defaults a run takes about two seconds at most, and its record 200 MB; a decay of the paper's needs a few
// thousand impacts and a time of 1200.
struct Budget {
  // >= 0; <= most_rows (run.hpp) if impacts, contacts or energy are recorded.
  std::int64_t max_impacts = 200'000;
  std::int64_t max_half_cycles = 200'000;  // >= 1; <= most_rows if half cycles are recorded
  // > 0, <= 1e12. Absent: 500 000, divided by omega_f if there is a force with omega_f > 1.
  std::optional<double> max_time;

  bool operator==(const Budget&) const = default;
};

// Default limit on the steps of the searches for events plus the panels of the energy quadratures that a run
// of the exact or restitution engine may take. A scene that is not stiff needs about three million until one
// of the other default budgets ends it.
inline constexpr std::int64_t usual_search_steps = 10'000'000;

struct Exact {
  static constexpr std::string_view name = "exact", meaning = "compliant walls in closed form, no time step";
  static constexpr bool rigid_walls = false;
  Calibration calibration = Calibration::fixed_wall;
  Budget budget;
  std::int64_t max_steps = usual_search_steps;  // > 0

  bool operator==(const Exact&) const = default;
};

struct Restitution {
  static constexpr std::string_view name = "restitution", meaning = "rigid walls, instantaneous impacts";
  static constexpr bool rigid_walls = true;
  // Bounce-down (complete chattering) is replaced by its limit, the accumulation point, once the relative
  // acceleration changes by less than this fraction in the time left until that point (restitution.hpp).
  // In (0, 1e-3].
  double accumulation_tolerance = 1e-8;
  Budget budget;
  std::int64_t max_steps = usual_search_steps;  // > 0

  bool operator==(const Restitution&) const = default;
};

struct Cem {
  static constexpr std::string_view name = "cem",
                                    meaning = "the component element method, central differences";
  static constexpr bool rigid_walls = false;
  // h, > 0 and, unless `unstable`, at most the stability limit. Absent: a hundredth of the shortest of three
  // times: the nominal contact time; half a period of the primary mass, pi; with a force, half its period,
  // pi/omega_f.
  std::optional<double> time_step;
  Damper damper = Damper::centred;
  bool locate = false;  // locate touch and release inside the step
  // The large step, > time_step, < 2, and <= pi/omega_f with a force. While no wall can be met the steps are
  // whole multiples of time_step, at most this long; in a sustained contact, once the masses follow (M17.23),
  // they are half the stability limit (cem_rates.hpp). Absent: all steps are time_step.
  std::optional<double> large_step;
  // The paper's stuck regime, equation (9): an impact with a relative speed below u, while the wall pushes
  // the secondary mass, joins both masses (M9.10), at a loss of (M9.11), until x'' changes its sign. u > 0
  // and finite, divided by epsilon Omega_n. Absent: sticking is a sustained contact with the compliant wall.
  std::optional<double> stuck_speed;
  bool unstable = false;  // run even with a step beyond the stability limit
  Calibration calibration = Calibration::fixed_wall;
  std::int64_t max_steps = 300'000'000;  // time steps, > 0; ends a run whose step is too small for its length
  Budget budget;

  bool operator==(const Cem&) const = default;
};

// The default u of `--stuck paper`. From a relative acceleration a towards the wall an impact slower than
// about 2 a / omega_c does not separate (docs/mathematics.md, 9.1): 0.014 for a = 5, k = 1e4, nu = 0.02, near
// which the paper's bounce-down ends.
inline constexpr double usual_stuck_speed = 0.01;

using Engine = std::variant<Exact, Restitution, Cem>;

// One of each with its default options, in the order of the variant.
const std::vector<Engine>& default_engines();
std::vector<std::string_view> engine_names();

// The problems of the options, each checked by itself; reported as by problems_of(Scene). simulate() checks
// what depends on the scene or on what is recorded.
std::vector<Problem> problems_of(const Engine& engine);
bool has_rigid_walls(const Engine& engine);
Calibration calibration_of(const Engine& engine);  // the default for an engine without one

std::string_view name_of(const Engine& engine);
std::string_view name_of(Calibration calibration);  // "fixed-wall", "two-body"

}  // namespace impact_damper
