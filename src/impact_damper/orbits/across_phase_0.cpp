#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "impact_damper/motion/wall.hpp"
#include "impact_damper/orbits/corrector.hpp"
#include "impact_damper/orbits/variational_equations.hpp"

namespace impact_damper::corrector {
namespace {

// The state after one event, and its derivative by the state before.
struct Step {
  StateMatrix by_state;
  StateVector state;
};

// The numbers of one damper and its cavity.
struct Cavity {
  std::size_t damper;
  double mass_ratio, restitution, clearance, holding, wall_damping;

  bool contains(double y) const { return y >= 0 && y <= clearance; }
  double nearer_wall(double y) const { return y < clearance / 2 ? 0 : clearance; }
};
std::vector<Cavity> cavities_of(const Scene& scene, const Engine& engine) {
  std::vector<Cavity> all;
  const auto* const exact = std::get_if<Exact>(&engine);
  for (const SceneDamper& each : scene.dampers) {
    const double damping = exact ? 2 * zeta_m<double>(each, exact->calibration) * omega_m(each) : 0;
    all.push_back({all.size(), each.mass_ratio, each.restitution, each.clearance, each.holding(), damping});
  }
  return all;
}

// Takes a mass that lies beyond a rigid wall across its impact (M13.13), or back if it moves away from the
// wall. All others fly. Nothing if it has no speed, or an impact with e = 0 would have to be undone.
std::optional<Step> across_impact(const Scene& scene, const Cavity& cavity, const StateVector& s) {
  const std::size_t y = index_of_y(cavity.damper), w = index_of_w(cavity.damper);
  const double wall = s[y] < 0 ? 0 : cavity.clearance, away = s[y] < 0 ? 1 : -1, e = cavity.restitution;
  const bool approaching = away * s[w] < 0;
  if (!approaching && !(away * s[w] > 0 && e > 0)) return {};
  // (M13.5) or, where the mass leaves the wall, its inverse.
  StateMatrix jump = identity_of(s.size());
  double gained = cavity.mass_ratio * (1 + e) / (1 + cavity.mass_ratio);
  if (!approaching) gained /= e;
  jump[1][w] = gained;
  for (std::size_t i = 3; i < s.size(); i += 2) jump[i][w] = -gained;
  jump[w][w] = approaching ? -e : -1 / e;
  const auto rates = [&](const StateVector& at) {
    double a = -2 * scene.damping_ratio * at[1] - at[0];  // the force is 0 at phase 0
    std::vector<double> pulls;
    for (std::size_t i = 0; i < scene.dampers.size(); ++i) {
      const double its_w = at[index_of_w(i)];
      const double in_cavity = scene.dampers[i].friction * (its_w > 0   ? 1
                                                            : its_w < 0 ? -1
                                                                        : 0) +
                               scene.dampers[i].drag * its_w;
      a += scene.dampers[i].mass_ratio * in_cavity;
      pulls.push_back(in_cavity + scene.weight);
    }
    StateVector all{at[1], a};
    for (std::size_t i = 0; i < pulls.size(); ++i)
      all.insert(all.end(), {at[index_of_w(i)], -(a + pulls[i])});
    return all;
  };
  const auto moved = [](StateVector from, const StateVector& by, double time) {
    for (std::size_t i = 0; i < from.size(); ++i) from[i] += by[i] * time;
    return from;
  };
  const double since = (s[y] - wall) / s[w];
  const StateVector before = rates(s);
  const StateVector at_wall = product(jump, moved(s, before, -since));
  const StateVector after = rates(at_wall);
  Step step{jump, moved(at_wall, after, since)};
  for (std::size_t i = 0; i < s.size(); ++i) {  // the saltation matrix (M13.4)
    double jump_of_rate = after[i];             // row i of F^+ - D F^-
    for (std::size_t k = 0; k < s.size(); ++k) jump_of_rate -= jump[i][k] * before[k];
    step.by_state[i][y] += jump_of_rate / s[w];
  }
  return step;
}

// Takes a mass across the touch of a compliant wall, or the end of the contact (M13.35), to first order: the
// branch has a kink there. held: whether friction holds the mass with y' at an index; joined_mass: that
// of the primary mass and all that is held.
Step across_edge(const Cavity& cavity, const std::vector<bool>& held, double joined_mass, bool into_contact,
                 StateVector s) {
  const std::size_t y = index_of_y(cavity.damper), w = index_of_w(cavity.damper);
  const double share = cavity.mass_ratio / joined_mass, force = (into_contact ? 1 : -1) * cavity.wall_damping,
               shared = share * force;
  StateMatrix edge = identity_of(s.size());
  edge[1][y] = shared;
  for (std::size_t i = 3; i < s.size(); i += 2)
    if (!held[i]) edge[i][y] = -shared;
  edge[w][y] = -(1 + share) * force;
  const double q = s[y] - cavity.nearer_wall(s[y]);
  for (std::size_t i = 1; i < s.size(); i += 2) s[i] += edge[i][y] * q;
  return {std::move(edge), std::move(s)};
}

}  // namespace

std::optional<Crossing> across_phase_0(const Scene& scene, const Engine& engine, const StateVector& before,
                                       const StateVector& s) {
  Crossing all{s, {}};
  const auto take = [&](Step step) {
    all.state = std::move(step.state);
    all.by_state.push_back(std::move(step.by_state));
  };
  const std::vector<Cavity> cavities = cavities_of(scene, engine);
  constexpr double rounding = 1e-13;
  if (!has_rigid_walls(engine)) {
    std::vector<bool> held(s.size(), false);
    double joined_mass = 1;
    for (const Cavity& cavity : cavities) {
      const std::size_t w = index_of_w(cavity.damper);
      if (!(cavity.holding > 0 && std::fabs(s[w]) < rounding)) continue;
      all.state[w] = 0;
      held[w] = true;
      joined_mass += cavity.mass_ratio;
    }
    for (const Cavity& cavity : cavities) {
      const std::size_t y = index_of_y(cavity.damper);
      const bool into_contact = cavity.contains(before[y]);
      if (into_contact == cavity.contains(all.state[y]) || held[index_of_w(cavity.damper)]) continue;
      take(across_edge(cavity, held, joined_mass, into_contact, all.state));
    }
    return all;
  }
  bool some_rest = false;
  for (const Cavity& cavity : cavities) {
    double &y = all.state[index_of_y(cavity.damper)], &w = all.state[index_of_w(cavity.damper)];
    const double wall = cavity.nearer_wall(y);
    const bool on_wall = std::fabs(y - wall) < rounding;
    if (!(std::fabs(w) < rounding && (on_wall || cavity.holding > 0))) continue;
    if (on_wall) y = wall;
    w = 0;
    some_rest = true;
  }
  for (std::size_t impacts = 0; impacts < 8 * cavities.size(); ++impacts) {
    const auto beyond = std::ranges::find_if(cavities, [&](const Cavity& cavity) {
      return !cavity.contains(all.state[index_of_y(cavity.damper)]);
    });
    if (beyond == cavities.end()) return all;
    std::optional<Step> step;
    if (!some_rest) step = across_impact(scene, *beyond, all.state);
    if (!step) return {};
    take(std::move(*step));
  }
  return {};
}

}  // namespace impact_damper::corrector
