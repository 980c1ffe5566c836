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

#include "impact_damper/scene.hpp"

namespace impact_damper {

// How the wall's damping ratio zeta_m follows from the restitution e (wall.hpp).
enum class Calibration {
  fixed_wall,  // the paper's: the primary mass is held still
  two_body,    // both masses free: the delivered restitution is e exactly
};

// Which velocity the wall damper of the component element method sees.
enum class Damper {
  centred,  // (y_{n+1} - y_{n-1}) / 2h: implicit in the new step, second order
  lagged,   // (y_n - y_{n-1}) / h: one step behind, explicit
};

// Where a run ends that nothing else ends. A budget that is used up is a stop reason, never an error. The
// defaults let no scene run for more than a second or two, nor its record grow beyond 200 MB; a decay of the
// paper's needs a few thousand impacts and a time of 1200.
struct Budget {
  std::int64_t max_impacts = 200'000;      // >= 0; at most most_rows where they are recorded
  std::int64_t max_half_cycles = 200'000;  // >= 1; the same
  std::optional<double> max_time;  // > 0, <= 1e12; absent: 500 000, by 1/omega_f where the forcing is faster

  bool operator==(const Budget&) const = default;
};

// Steps of the searches for events, and panels of the quadratures of energy, that a run in closed form may
// take: a budget like the others. All that the other default budgets allow of a scene that is not stiff takes
// about three million.
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
  // Bounce-down jumps to its accumulation point once the rest of it is so short that the relative
  // acceleration changes by less than this fraction in it (restitution.hpp). In (0, 1e-3].
  double accumulation_tolerance = 1e-8;
  Budget budget;
  std::int64_t max_steps = usual_search_steps;  // > 0

  bool operator==(const Restitution&) const = default;
};

struct Cem {
  static constexpr std::string_view name = "cem",
                                    meaning = "the component element method, central differences";
  static constexpr bool rigid_walls = false;
  // h, > 0; absent: a hundredth of the shortest of the nominal contact time, half a period of the primary
  // mass, pi, and with forcing half a period of that, pi/omega_f.
  std::optional<double> time_step;
  Damper damper = Damper::centred;
  bool locate = false;  // locate touch and release inside the step
  // H, > h, < 2 and with forcing <= pi/omega_f: while no wall can be met steps of whole multiples of h, up to
  // this long (cem_rates.hpp). Absent: all steps are h.
  std::optional<double> large_step;
  // The paper's stuck regime, u > 0 and finite: an impact slower than u that presses the secondary mass to
  // the wall joins both masses, until x'' changes its sign. Absent: sticking is a contact that lasts.
  std::optional<double> stuck_speed;
  bool unstable = false;  // run even beyond the stability limit
  Calibration calibration = Calibration::fixed_wall;
  std::int64_t max_steps = 300'000'000;  // > 0; a budget like the others, for steps too small for the scene
  Budget budget;

  bool operator==(const Cem&) const = default;
};

// u where the paper's regime is chosen without one. From a relative acceleration a towards the wall an impact
// slower than about 2 a / omega_c does not separate (docs/mathematics.md, 9.1): 0.014 for a = 5, k = 1e4,
// nu = 0.02, near which the paper's bounce-down ends.
inline constexpr double usual_stuck_speed = 0.01;

using Engine = std::variant<Exact, Restitution, Cem>;

// One of each with its default options: every list of engines is made of these.
const std::vector<Engine>& default_engines();
std::vector<std::string_view> engine_names();

// What is wrong with the options, each by itself, as problems_of(Scene).
std::vector<Problem> problems_of(const Engine& engine);
bool has_rigid_walls(const Engine& engine);

std::string_view name_of(const Engine& engine);
std::string_view name_of(Calibration calibration);  // "fixed-wall", "two-body"
std::string_view name_of(Damper damper);            // "centred", "lagged"

}  // namespace impact_damper
