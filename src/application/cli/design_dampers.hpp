// `design --dampers`: several dampers for a range of amplitudes.
#pragma once

#include "commands.hpp"

namespace impact_damper::cli {

int design_dampers(Arguments& arguments);

}  // namespace impact_damper::cli
