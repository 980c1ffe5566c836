#include "impact_damper/paper/measure_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace impact_damper {
namespace {

constexpr NumberRange above_up_to(double least, double most) { return {least, most, false}; }
constexpr NumberRange amplitudes = above_up_to(0, 1e12);

}  // namespace

const std::vector<MeasureNumber>& measure_numbers() {
  static const std::vector<MeasureNumber> table{
      {"amplitude", amplitudes, false, "amplitude of a half cycle, by the free travel"},
      {"damping_ratio", above_up_to(0, 0.5), false,
       "viscous damping ratio zeta of a decay with enough peaks"},
      {"eta", above_up_to(0, 1e3), false, "averaged loss factor per radian"},
      {"factor", above_up_to(1, 1e3), false, "by how much a value or a time step is divided"},
      {"from", amplitudes, false, "least amplitude looked at, by the free travel; below \"to\""},
      {"half_cycles", within(1, 1000), true,
       "half cycles looked at; as a window of averaging even, 10 to 18"},
      {"impacts", within(0, 1000), true, "impacts in a half cycle"},
      {"last", within(1, 10000), true, "how many of the last rows of a curve"},
      {"mass_ratio", above_up_to(0, 1e6), false, "mass ratio nu of a scene of the measure's own"},
      {"most", within(1, 1000), true, "impacts per half cycle in the highest regular window"},
      {"power", within(-10, 10), false, "power of the amplitude that the impacts' speed is divided by"},
      {"restitution", within(0, 1), false, "coefficient of restitution e"},
      {"steps_per_contact", within(1, 1000), false, "time steps in a nominal contact"},
      {"stiffness", above_up_to(0, 1e15), false, "wall to primary spring stiffness k of the other walls"},
      {"to", amplitudes, false, "largest amplitude looked at, by the free travel"},
      {"until_time", above_up_to(0, 1e3), false, "end of a scene of the measure's own, by 1/Omega_n"},
      {"x0", above_up_to(0, 1e6), false, "release of a scene of the measure's own, by the free travel"},
  };
  return table;
}

bool MeasureNumber::admits(double value) const {
  return range.admits(value) && !(whole && value != std::floor(value));
}

const MeasureNumber& measure_number(std::string_view name) {
  const auto found = std::ranges::find(measure_numbers(), name, &MeasureNumber::name);
  if (found == measure_numbers().end())
    throw std::logic_error("no measure has a number called " + std::string(name));
  return *found;
}

}  // namespace impact_damper
