#include "application/reproduction/measure_numbers.hpp"

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
      {"amplitude", amplitudes, 0, "amplitude of a half cycle, in units of the clearance"},
      {"averaged_over", within(10, 18), 2, "half cycles that the loss factor is averaged over"},
      {"damping_ratio", above_up_to(0, 0.5), 0, "viscous damping ratio zeta of a decay with enough peaks"},
      {"eta", above_up_to(0, 1e3), 0, "averaged loss factor per radian"},
      {"factor", above_up_to(1, 1e3), 0, "by how much a value or a time step is divided"},
      {"from", amplitudes, 0, "least amplitude looked at, in units of the clearance; below \"to\""},
      {"half_cycles", within(1, 1000), 1, "half cycles looked at"},
      {"impacts", within(0, 1000), 1, "impacts in a half cycle"},
      {"last", within(1, 10000), 1, "how many of the last rows of a curve"},
      {"mass_ratio", above_up_to(0, 1e6), 0, "mass ratio nu of a scene of the measure's own"},
      {"most", within(1, 1000), 1, "impacts per half cycle in the highest regular window"},
      {"power", within(-10, 10), 0, "power of the amplitude that the impacts' speed is divided by"},
      {"restitution", within(0, 1), 0, "coefficient of restitution e"},
      {"steps_per_contact", within(1, 1000), 0, "time steps in a nominal contact"},
      {"stuck_speed", above_up_to(0, 1e6), 0, "relative speed of impact below which the masses join"},
      {"to", amplitudes, 0, "largest amplitude looked at, in units of the clearance"},
      {"until_time", above_up_to(0, 1e3), 0, "end of a scene of the measure's own, in units of 1/Omega_n"},
      {"within", within(0, 0.9), 0, "share by which a constant may be missed either way"},
      {"x0", above_up_to(0, 1e6), 0, "release of a scene of the measure's own, in units of the clearance"},
  };
  return table;
}

bool MeasureNumber::allows(double value) const {
  return range.allows(value) && (multiple_of == 0 || std::fmod(value, multiple_of) == 0);
}

const MeasureNumber& measure_number(std::string_view name) {
  const auto found = std::ranges::find(measure_numbers(), name, &MeasureNumber::name);
  if (found == measure_numbers().end())
    throw std::logic_error("no measure has a number called " + std::string(name));
  return *found;
}

}  // namespace impact_damper
