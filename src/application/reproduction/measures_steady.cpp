// Measures on steady motions under a force: compared with the prediction from a free decay
// (docs/mathematics.md, chapter 14: M14.9, which follows from M14.6, M14.7 and M14.8), with each other, and
// with the closed form of two impacts in a period.
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "application/reproduction/measures_parts.hpp"
#include "impact_damper/math/elementary.hpp"
#include "impact_damper/orbits/two_impact_orbit.hpp"
#include "impact_damper/responses/response_file.hpp"

namespace impact_damper {
namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

// Returns the response of that name. Throws std::invalid_argument if it is of another kind.
template <class Kind>
const Kind& response_of(const Asked& asked, const std::string& name) {
  const auto* const found = std::get_if<Kind>(&asked.runs.response(name));
  if (!found) throw std::invalid_argument(name + ": must be a " + std::string(Kind::kind));
  return *found;
}

double amplitude_of(const SteadyState& steady) { return steady.means ? steady.means->amplitude : no_number; }

constexpr SweepWay rising = &Sweep::up, falling = &Sweep::down;

// Returns the sweeps of a call. Throws std::invalid_argument unless all responses have equally many, each
// from its own start.
std::vector<const SweepResponse*> sweeps_of(const Asked& asked) {
  std::vector<const SweepResponse*> responses;
  for (const std::string& name : asked.call.responses) {
    responses.push_back(&response_of<SweepResponse>(asked, name));
    if (responses.back()->sweeps.size() != responses.front()->sweeps.size())
      throw std::invalid_argument(name + ": must have as many starts as all responses of the measure");
  }
  return responses;
}

// Returns, for each start, the largest amplitude at each force of the sweeps. Throws std::invalid_argument if
// they are not over the same forces.
std::vector<Curve> largest_amplitudes(const Asked& asked, SweepWay way) {
  const std::vector<const SweepResponse*> responses = sweeps_of(asked);
  for (std::size_t i = 0; i < responses.size(); ++i)
    if (!responses[i]->axis.number.is(&Scene::force_amplitude) ||
        responses[i]->axis.values() != responses.front()->axis.values())
      throw std::invalid_argument(asked.call.responses[i] +
                                  ": must be over the same forces as all responses of the measure");
  return largest_amplitudes(responses, way);
}

// Returns F over A (M14.7) from the amplitude of the largest F downwards, in the order of time; A in [from,
// to].
Curve needed_force(const Asked& asked, const Run& run) {
  Curve curve = loss_curve(asked, run, LossOrdinate::eta);
  const double carried = square_root(1 + run.scene.damper().mass_ratio);
  for (std::size_t i = 0; i < curve.x.size(); ++i) curve.y[i] *= carried * curve.x[i];
  const auto top = std::ranges::max_element(curve.y) - curve.y.begin();
  curve.x.erase(curve.x.begin(), curve.x.begin() + top);
  curve.y.erase(curve.y.begin(), curve.y.begin() + top);
  return curve;
}

// Applies find(amplitudes, needed) for each start of the sweeps to each member of the decay's ensemble.
template <class Find>
Spread over_starts(const Asked& asked, SweepWay way, Find find) {
  std::vector<Curve> needed;
  for (const Run& decay : asked.ensemble()) needed.push_back(needed_force(asked, decay));
  std::vector<double> values;
  for (const Curve& found : largest_amplitudes(asked, way))
    for (const Curve& by_decay : needed) values.push_back(find(found, by_decay));
  return spread_of(values);
}

// Returns the amplitude by (M14.9), linear between the curve's points; NaN for a force above or below all of
// it.
double predicted_amplitude(const Curve& needed, double force) {
  for (std::size_t i = 0; i + 1 < needed.x.size() && force <= needed.y[0]; ++i) {
    if (!(needed.y[i + 1] <= force)) continue;
    const double part = (needed.y[i] - force) / (needed.y[i] - needed.y[i + 1]);
    return needed.x[i] + part * (needed.x[i + 1] - needed.x[i]);
  }
  return no_number;
}

template <SweepWay way, double (*of_all)(const std::vector<double>&)>
Spread amplitude_error_percent(const Asked& asked) {
  return over_starts(asked, way, [](const Curve& found, const Curve& needed) {
    std::vector<double> errors;
    for (std::size_t i = 0; i < found.x.size(); ++i) {
      const double predicted = predicted_amplitude(needed, found.x[i]);
      if (predicted == predicted) errors.push_back(100 * std::abs(found.y[i] / predicted - 1));
    }
    return of_all(errors);
  });
}

// Numbers of points of a map that end in a motion with one impact on each wall in a period of the force.
struct TwoImpactPoints {
  std::int64_t symmetric = 0, all = 0;
};
TwoImpactPoints two_impact_points(const Basin& basin) {
  TwoImpactPoints points;
  for (const Attractor& each : basin.attractors) {
    if (each.idle || each.period != 1 || each.impacts != ImpactCounts{1, 1}) continue;
    points.all += each.points;
    if (each.symmetric) points.symmetric += each.points;
  }
  return points;
}

// Returns the relative difference of the power lost in impacts from that of the closed form, of whose two
// orbits the nearer counts. An impact with the relative speed w dissipates nu (1 - e^2) w^2 / (2 (1 + nu)).
double power_error(const Scene& scene, double impact_power) {
  const double nu = scene.damper().mass_ratio, e = scene.damper().restitution;
  double least = std::numeric_limits<double>::infinity();
  for (const TwoImpactOrbit& orbit : two_impact_orbits(scene)) {
    const double w = orbit.impact_speed, frequency = scene.force_frequency / (2 * half_turn<double>());
    const double power = 2 * frequency * nu * (1 - e * e) * w * w / (2 * (1 + nu));
    least = std::min(least, std::abs(impact_power / power - 1));
  }
  return least;
}

}  // namespace

std::vector<Measure> steady_measures() {
  return {
      {"steady_amplitude_falling_percent",
       "relative deviation of the largest steady amplitude, reached with the force falling, from that "
       "predicted by the decay (M14.9), mean over the forces that have a prediction in [from, to], in "
       "percent; for each start of the sweeps, by each decay",
       amplitude_error_percent<falling, mean>, numbers("from", "to"), scenes(1, 1), responses(1, 8)},
      {"steady_amplitude_falling_worst_percent", "the largest of these deviations",
       amplitude_error_percent<falling, most>, numbers("from", "to"), scenes(1, 1), responses(1, 8)},
      {"steady_amplitude_rising_percent", "the mean with the force rising",
       amplitude_error_percent<rising, mean>, numbers("from", "to"), scenes(1, 1), responses(1, 8)},
      {"steady_amplitude_rising_worst_percent", "the largest of these", amplitude_error_percent<rising, most>,
       numbers("from", "to"), scenes(1, 1), responses(1, 8)},
      {"force_limit_ratio",
       "rising force at which the largest steady amplitude exceeds that of the largest F of the decay, A in "
       "[from, to], divided by this F (M14.7)",
       [](const Asked& asked) {
         return over_starts(asked, rising, [](const Curve& found, const Curve& needed) {
           if (needed.x.empty()) return no_number;
           for (std::size_t i = 0; i + 1 < found.x.size(); ++i) {
             if (!(found.y[i] <= needed.x[0] && found.y[i + 1] > needed.x[0])) continue;
             const double part = (needed.x[0] - found.y[i]) / (found.y[i + 1] - found.y[i]);
             return (found.x[i] + part * (found.x[i + 1] - found.x[i])) / needed.y[0];
           }
           return no_number;
         });
       },
       numbers("from", "to"), scenes(1, 1), responses(1, 8)},
      {"force_jump_ratio",
       "falling force at which the largest steady amplitude falls below 0.5, divided by the least F of the "
       "decay between from and the amplitude of its largest F in [from, to]",
       [](const Asked& asked) {
         constexpr double half_of_the_clearance = 0.5;
         return over_starts(asked, falling, [](const Curve& found, const Curve& needed) {
           std::size_t least = found.x.size();  // index of the least force from which on that holds
           while (least > 0 && found.y[least - 1] >= half_of_the_clearance) --least;
           if (needed.y.empty() || least == 0 || least == found.x.size()) return no_number;
           return (found.x[least - 1] + found.x[least]) / 2 / *std::ranges::min_element(needed.y);
         });
       },
       numbers("from", "to"), scenes(1, 1), responses(1, 8)},
      {"one_motion_share",
       "share of the values of sweeps at which the rising and the falling way arrive at one amplitude "
       "(M12.8)",
       [](const Asked& asked) {
         const std::vector<const SweepResponse*> responses = sweeps_of(asked);
         std::vector<double> shares;
         for (std::size_t n = 0; n < responses.front()->sweeps.size(); ++n) {
           std::vector<double> same;
           for (const SweepResponse* response : responses)
             for (std::size_t i = 0; i < response->sweeps[n].up.size(); ++i) {
               const SteadyState &up = response->sweeps[n].up[i], &down = response->sweeps[n].down[i];
               const double a = amplitude_of(up), b = amplitude_of(down);
               const bool differ = amplitudes_differ(a, up.amplitude_scatter, b, down.amplitude_scatter);
               same.push_back(a == a && b == b ? double(!differ) : no_number);
             }
           shares.push_back(mean(same));
         }
         return spread_of(shares);
       },
       numbers(), scenes(0, 0), responses(1, 8)},
      {"two_impact_share",
       "share of the points of a map that end in a motion with two equally spaced impacts in a period of the "
       "force, one on each wall",
       [](const Asked& asked) {
         const Basin& basin = response_of<BasinResponse>(asked, asked.call.responses.front()).basin;
         return static_cast<double>(two_impact_points(basin).symmetric) /
                static_cast<double>(basin.attractor.size());
       },
       numbers(), scenes(0, 0), responses(1, 1)},
      {"equally_spaced_share", "share of these among all with one impact on each wall in a period",
       [](const Asked& asked) {
         const TwoImpactPoints points =
             two_impact_points(response_of<BasinResponse>(asked, asked.call.responses.front()).basin);
         return static_cast<double>(points.symmetric) / static_cast<double>(points.all);
       },
       numbers(), scenes(0, 0), responses(1, 1)},
      {"two_impact_error",
       "largest relative deviation of the power that impacts take out of such a motion of sweeps from that "
       "of the closed form (M13.18)",
       [](const Asked& asked) {
         std::vector<double> errors;
         for (const std::string& name : asked.call.responses) {
           const auto& response = response_of<SweepResponse>(asked, name);
           for (std::int64_t i = 0; i < response.axis.count; ++i) {
             const Scene scene = response.axis.at(response.scene, i);
             // The closed form uses the linear response, which does not exist at resonance without damping.
             if (scene.force_frequency == 1 && scene.damping_ratio == 0) continue;
             for (const Sweep& sweep : response.sweeps)
               for (const SweepWay way : {rising, falling})
                 if (const SteadyState& each = (sweep.*way)[std::size_t(i)];
                     each.period == 1 && each.symmetric && each.impacts == ImpactCounts{1, 1})
                   errors.push_back(power_error(scene, each.means->impact_power));
           }
         }
         return most(errors);
       },
       numbers(), scenes(0, 0), responses(1, 8)},
  };
}

}  // namespace impact_damper
