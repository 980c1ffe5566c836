// The lightest secondary mass, and its clearance, with which a free decay comes from its release below an
// amplitude within a time, although restitution, clearance and other numbers are not exactly what they were
// meant to be (docs/mathematics.md, chapter 15). Masses in kg, lengths in mm, times in s.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/sweeps/plan.hpp"

namespace impact_damper {

// Where the probability of an event lies that was seen `count` times in `of` > 0 independent trials: Wilson's
// interval (M15.9), which holds it with a probability of 95 %.
struct ShareInterval {
  double low = 0, high = 1;
};
ShareInterval interval_of_share(std::int64_t count, std::int64_t of);

struct DesignRange {
  double least = 0, most = 0;  // 0 < least < most
};

struct DesignQuestion {
  // A free decay, with the secondary mass released at the left wall. Secondary mass, clearance and stops are
  // not used by the search, but design_text() needs the first two.
  SceneInUnits scene;
  Engine engine;
  double amplitude = 0;  // to come below, mm: > 0 and < |initial displacement|
  double time = 0;       // s, > 0
  // Of what the tolerances make of a design this share must do so, 0.5 <= share <= 0.999.
  double share = 0.99;
  DesignRange secondary_mass, clearance;
  std::vector<SampledNumber> tolerances;  // uniform about the design's value; at least one
  std::int64_t neighbours = 10'000;       // >= 1, with which a design is checked
  std::int64_t seed = 1;                  // >= 0; of the search, seed + 1 of the check
};
inline constexpr double most_mass_ratio = 0.2, least_mass_ratio = 0.005;  // of the default range
// Beside a primary mass, to three digits.
DesignRange default_masses(double mass);
// The clearance with which impacts fail at an amplitude (M15.12); absent for e = 1, with which they never do.
std::optional<double> failing_clearance(double amplitude, double restitution);
// From the amplitude to come below up to the clearance that (M12.3) recommends for it, at most 100 times as
// wide, to three digits.
DesignRange default_clearances(double amplitude, double restitution);

// A dimensionless scene as one with M = 1 kg, K = 1 N/m and a clearance of 1 mm: its seconds are 1/Omega_n.
SceneInUnits with_unit_scales(const Scene& scene);
// The same scene with what it has by default written out, so that it can vary about that.
SceneInUnits with_defaults(SceneInUnits scene);

// Fields: those of DesignQuestion, or of the scene.
std::vector<Problem> problems_of(const DesignQuestion& question);

struct Design {
  double secondary_mass = 0, clearance = 0;

  bool operator==(const Design&) const = default;
};
// The design as a scene that ends below the amplitude, or at `time`. Of the result only in_units is set: the
// dimensionless scene is dimensionless(*file.in_units). The same holds for the scenes of the two plans below,
// whose question must be valid.
SceneFile scene_of_design(const DesignQuestion& question, const Design& design, double time);
// What the search runs: all pairs of masses and clearances, each with the same draws.
Plan search_plan(const DesignQuestion& question, double time, std::vector<double> masses,
                 std::vector<double> clearances);
// What a design is checked with: other draws, followed for longest_followed times the time.
Plan check_plan(const DesignQuestion& question, const Design& design);
inline constexpr double longest_followed = 10;

struct DesignCheck {
  std::optional<double> nominal_time;  // of the design itself; absent: later than it was followed
  std::int64_t in_time = 0;            // neighbours within the time of the design
  ShareInterval share;                 // where their share lies
  // Within which the question's share of the neighbours is down, and all of them; absent as above.
  std::optional<double> time_of_share, slowest;
  double largest_impact_speed = 0;           // of all neighbours, mm/s
  std::optional<double> largest_wall_force;  // N; absent with rigid walls and long contacts
  // share.low >= the question's, share.high < the question's; neither: the neighbours do not decide.
  bool confirmed = false, rejected = false;
};
struct FoundDesign {
  double time = 0, widest = 0;  // the time and the widest clearance that the search was given
  Design design;
  DesignCheck check;
};
struct DesignAnswer {
  std::int64_t draws = 0, late_allowed = 0;  // of a design in the search
  std::int64_t runs = 0;                     // of the search
  // Of the primary mass alone; absent as DesignCheck::nominal_time.
  std::optional<double> time_of_viscous_damping;
  // The lightest design, then those with half and a quarter of the widest clearance and for 0.8 and 0.6 of
  // the time, where there are such and they are others. If there is none: one, the heaviest secondary mass
  // with the clearance for which it is down soonest, `met` being false; or none, if that takes longer than
  // longest_followed times the time.
  std::vector<FoundDesign> designs;
  bool met = false;
};
// Throws InvalidArguments if the question is not valid. The same with any number of threads.
DesignAnswer find_designs(const DesignQuestion& question, const Threads& threads,
                          const std::function<void(const std::string& doing)>& tell);

// Parts of it. The late draws that (M15.10) allows among `draws`; -1 if even none are too few draws.
std::int64_t late_allowed_of(std::int64_t draws, double share);
// The least number of draws for which these are not too few.
std::int64_t least_neighbours_of(double share);
// From least to most in steps of that ratio > 1, rounded to three digits, both ends as they are (M15.11).
std::vector<double> steps_between(DesignRange range, double ratio);

}  // namespace impact_damper
