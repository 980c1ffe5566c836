#include "impact_damper/engine.hpp"

namespace impact_damper {

std::string_view name_of(const Engine& engine) {
  return std::visit([](const auto& options) { return options.name; }, engine);
}

std::string_view name_of(Calibration calibration) {
  switch (calibration) {
    case Calibration::fixed_wall:
      return "fixed-wall";
    case Calibration::two_body:
      return "two-body";
  }
  return {};
}

std::string_view name_of(Damper damper) {
  switch (damper) {
    case Damper::centred:
      return "centred";
    case Damper::lagged:
      return "lagged";
  }
  return {};
}

}  // namespace impact_damper
