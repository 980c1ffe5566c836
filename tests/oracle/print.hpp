// The oracle's numbers as text.
#pragma once

#include <string>

#include "oracle.hpp"

namespace oracle {

std::string text(Quad number, int digits = 25);
// One event a line, in order of time, then the energies.
std::string lines_of(const Answer& answer);

}  // namespace oracle
