// Search for the lightest secondary mass, and its clearance, with which a free decay falls below an amplitude
// within a time, or steady motions under a force stay below an amplitude, or both, even if restitution,
// clearance and other numbers deviate within tolerances (docs/mathematics.md, chapter 15). Masses in kg,
// lengths in mm, times in s, forces in N, frequencies in Hz.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "application/sweeps/plan.hpp"
#include "impact_damper/analysis/parallel.hpp"

namespace impact_damper {

// Wilson's interval (M15.9): it contains the probability of an event that occurred `count` times in `of` > 0
// independent trials with a confidence of 95 %.
struct ShareInterval {
  double low = 0, high = 1;
};
ShareInterval interval_of_share(std::int64_t count, std::int64_t of);

struct DesignRange {
  double least = 0, most = 0;  // 0 < least < most
};

// Steady motions under a harmonic force must stay below an amplitude at all of these frequencies.
struct ForcedDemand {
  double force = 0;            // N, > 0
  double least = 0, most = 0;  // Hz, 0 < least < most
  double amplitude = 0;        // mm, > 0
};
// Largest steady amplitude, mm, and the frequency, Hz, at which it is met.
struct SteadyPeak {
  double amplitude = 0, frequency = 0;
};

struct DesignQuestion {
  // A free decay, with the secondary mass released at the left wall. The search does not use its secondary
  // mass, clearance and stops, but design_text() needs the first two.
  SceneInUnits scene;
  bool in_units = true;  // false: the scene was made by with_unit_scales()
  Engine engine;
  bool has_decay = true;  // false: the next two are not looked at
  double amplitude = 0;   // mm, > 0 and < |initial displacement|: the decay must fall below it
  double time = 0;        // s, > 0: and must do so within this time
  std::optional<ForcedDemand> forced;
  // Required share of neighbours that meet all this, 0.5 to 0.999. Neighbours are variations within the
  // tolerances.
  double share = 0.99;
  DesignRange secondary_mass, clearance;  // equal ends of the mass: it is given
  std::vector<SampledNumber> tolerances;  // uniform about the design's value; at least one
  std::int64_t neighbours = 10'000;       // >= 1, simulated in the check of a design
  // The check goes on with more, up to so many times as many, as long as they do not decide. >= 1.
  std::int64_t most_enlarged = 1;
  std::int64_t seed = 1;  // >= 0, for the search; the check uses seed + 1
};
inline constexpr double most_mass_ratio = 0.2, least_mass_ratio = 0.005;  // of the default range
// Defaults of a question with steady motions, each of which takes a hundred times as long as a decay.
inline constexpr double forced_share = 0.95;
std::int64_t forced_neighbours_of(double share);  // (M15.9) can confirm it with as many
// Returns the least amplitude that the question asks for.
double least_amplitude_of(const DesignQuestion& question);
// Returns the amplitude, mm, up to which friction and weight hold a secondary mass, kg, on the left wall of a
// cavity of any clearance (M15.14), about the place where the primary mass rests with it; 0 without them.
double locking_amplitude_of(const DesignQuestion& question, double secondary_mass);
// Returns the default range, kg, of those masses that are not held at the question's amplitude; if the
// lightest one is, of all. Rounded to three digits.
DesignRange default_masses(const DesignQuestion& question);
// Returns the clearance with which impacts fail at an amplitude (M15.12); absent for e = 1: they never fail.
std::optional<double> failing_clearance(double amplitude, double restitution);
// Returns the default range: from the amplitude up to the clearance that (M12.3) recommends for it, at most
// 100 times as wide, rounded to three digits.
DesignRange default_clearances(double amplitude, double restitution);

// Returns a dimensionless scene in units: M = 1 kg, K = 1 N/m, clearance 1 mm. Its second is 1/Omega_n. With
// friction, weight or drag it has a gravity and an inclination that give these.
SceneInUnits with_unit_scales(const Scene& scene);
// Returns the scene with default values written out, so that tolerances can vary them.
SceneInUnits with_defaults(SceneInUnits scene);

// Empty if the question is valid. Fields: those of DesignQuestion, with "tolerance", or of the scene.
std::vector<Problem> problems_of(const DesignQuestion& question);

struct Design {
  double secondary_mass = 0, clearance = 0;

  bool operator==(const Design&) const = default;
};
// Returns the design as a scene in units that ends below the amplitude, or at `time`. Only in_units is set,
// here and in the plans below; the dimensionless scene is dimensionless(*file.in_units). The plans need a
// valid question.
SceneFile scene_of_design(const DesignQuestion& question, const Design& design, double time);
// Returns the plan of the search: all pairs of masses and clearances, each with the same draws.
Plan search_plan(const DesignQuestion& question, double time, std::vector<double> masses,
                 std::vector<double> clearances);
// Returns the plan of a design's check: other draws, simulated for longest_followed times the question's
// time.
Plan check_plan(const DesignQuestion& question, const Design& design);
inline constexpr double longest_followed = 10;
// Returns the plan of steady motions of a design's neighbours: `draws` of `seed`, followed at `count`
// frequencies. The question must have a force.
Plan forced_plan(const DesignQuestion& question, const Design& design, std::int64_t draws, std::int64_t seed,
                 std::int64_t count);
// Numbers of them in the search and in a check.
inline constexpr std::int64_t forced_frequencies = 25, forced_check_frequencies = 49;
// Returns the plan of the check under the force.
Plan forced_check_plan(const DesignQuestion& question, const Design& design);
// Returns the steady peak of the primary mass alone (M15.15); absent if it is undamped at resonance. The
// question must have a force.
std::optional<SteadyPeak> peak_of_viscous_damping(const DesignQuestion& question);

struct DesignCheck {
  std::int64_t neighbours = 0;         // that were simulated
  std::optional<double> nominal_time;  // of the design itself; absent if its run ends earlier
  // Neighbours within the time of the design; of a question with a force, those that meet all it asks for.
  std::int64_t in_time = 0;
  ShareInterval share;  // interval of their share
  // Times by which the question's share of the neighbours, and all of them, are below the amplitude; absent
  // likewise.
  std::optional<double> time_of_share, slowest;
  double largest_impact_speed = 0;           // of all neighbours, mm/s
  std::optional<double> largest_wall_force;  // N; absent with rigid walls and long contacts
  // Under the force: of the design itself, of the worst neighbour that has one, and what the question's share
  // of all is within. Absent where motions are not steady.
  std::optional<SteadyPeak> nominal_peak, worst_peak;
  std::optional<double> amplitude_of_share;
  std::int64_t not_steady = 0;  // neighbours without a steady amplitude: they do not meet the requirement
  // confirmed: share.low >= the question's share; rejected: share.high < it; neither: the neighbours do not
  // decide.
  bool confirmed = false, rejected = false;
};
struct FoundDesign {
  // The time, the widest clearance and the steady amplitude that the search was given; 0 without such a
  // demand.
  double time = 0, widest = 0, amplitude = 0;
  Design design;
  DesignCheck check;
};
struct DesignAnswer {
  std::int64_t draws = 0, late_allowed = 0;  // in the search: draws of a design, of which so many may be late
  std::int64_t runs = 0;                     // of the search
  // Time of the primary mass alone; absent like DesignCheck::nominal_time.
  std::optional<double> time_of_viscous_damping;
  std::optional<SteadyPeak> peak_of_viscous_damping;  // likewise
  bool none_needed = false;  // the primary mass alone meets all: `met` is true and there are no designs
  // The lightest design, then the lightest with at most half and a quarter of the widest clearance, and for
  // 0.8 and 0.6 of the time, as far as they exist and differ. If no design is in time, `met` is false and the
  // only entry has the heaviest secondary mass and its soonest clearance; there is none if that takes longer
  // than longest_followed times the time.
  std::vector<FoundDesign> designs;
  bool met = false;
};
// Searches for the designs and checks them; `tell` receives a text for each stage that begins. Throws
// InvalidArguments if the question is not valid. The result does not depend on the number of threads.
DesignAnswer find_designs(const DesignQuestion& question, const Threads& threads,
                          const std::function<void(const std::string& doing)>& tell);

// Returns how many late draws (M15.10) allows among `draws`; -1 if these are too few even without a late one.
std::int64_t late_allowed_of(std::int64_t draws, double share);
// Returns the least number of draws that are not too few.
std::int64_t least_neighbours_of(double share);
// Returns values from `least` to `most` in steps of `ratio` > 1, rounded to three digits except both ends
// (M15.11).
std::vector<double> steps_between(DesignRange range, double ratio);

// Returns question and answer as JSON, schema "impact-damper/design/1" (data/schema/design.schema.json).
// The question's scene must have secondary_mass and clearance.
std::string design_text(const DesignQuestion& question, const DesignAnswer& answer);

// Returns a force of an answer in unit_of(Dimension::force, question.in_units). Unless it is in units, the
// question's scene must have a clearance.
double force_in_unit(double force, const DesignQuestion& question);
// Returns a frequency of an answer in unit_of(Dimension::frequency, question.in_units), likewise.
double frequency_in_unit(double frequency, const DesignQuestion& question);

}  // namespace impact_damper
