// A run by one of the closed-form engines with its variational equations: step by step what a small change of
// the state, of the force's frequency omega_f or of its amplitude f0 becomes along it, to first order
// (variation.hpp, docs/mathematics.md, 13.2 to 13.4). Numbers are dimensionless, as in run.hpp.
#pragma once

#include <optional>
#include <vector>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/orbits/orbit_impact.hpp"
#include "impact_damper/orbits/saltation.hpp"

namespace impact_damper {

// Base of a receiver of the variation, which is called during the run in the order of time. The run is
// reported in steps: each motion (a flight, a contact, a time of sticking) in one or several of equal
// duration, each event that acts on changes by itself (an impact, touch, the end of a contact, the beginning
// of sticking) in one.
class VariationReceiver {
 public:
  // with_parameters: whether the effects of changes of omega_f and f0 are computed, too.
  explicit VariationReceiver(bool with_parameters) : with_parameters_(with_parameters) {}
  virtual ~VariationReceiver() = default;

  // Rigid walls: called when sticking has begun, after the step of that event. Changes of y and y' are lost
  // with it, for the rest of the run.
  virtual void joined() = 0;
  // Returns in how many steps the next motion is reported: 1 with parameters, else at least 1. loss >= 0:
  // that motion multiplies the four-dimensional volume of a set of changes by exp(-loss), which one step may
  // lose in rounding errors.
  virtual int pieces(double loss) = 0;

  // Called by Variation; by_parameters() returns `added` of take().
  template <class ByParameters>
  void step(const RowsOfState<double, 4>& a, ByParameters&& by_parameters) {
    if (!with_parameters_) return take(a, nullptr);
    const RowsOfState<double, 2> added = by_parameters();
    take(a, &added);
  }

 private:
  // In this step a change s of the state (x, x', y, y') becomes a s, and changes (d omega_f, d f0) of the
  // force f0 sin(omega_f t), t from the run's beginning, add *added (d omega_f, d f0) to that. added: null
  // without parameters, else valid during the call.
  virtual void take(const RowsOfState<double, 4>& a, const RowsOfState<double, 2>* added) = 0;

  bool with_parameters_;
};

struct VariedRun {
  // The state in which the last motion ended, and its rates x', x'', y', y'': before any event at that
  // instant.
  State<double> end{};
  Rates<double> rates_at_end{};

  // These three with Kept::impacts only.
  std::vector<OrbitImpact> impacts;
  // Rigid walls: for each beginning of sticking the number of impacts so far, the one that it begins with
  // included.
  std::vector<std::size_t> impacts_before_sticking;
  // The least distance, of the whole run, from either wall (y = 0 and 1) at which y turns back without having
  // met it; absent if it never does.
  std::optional<double> nearest_miss;
};
enum class Kept { end, impacts };

// Runs the scene from its initial values to its until_time; or returns the budget that ended the run before.
// Not checked here: the scene is valid (problems_of), has a force, an until_time as its only stop and no list
// `dampers`, and the engine is exact or restitution, which are the closed-form ones.
Expected<VariedRun, StopReason> run_with_variation(const Scene& scene, const Engine& engine,
                                                   VariationReceiver& receiver, Kept kept);

}  // namespace impact_damper
