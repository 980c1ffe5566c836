// The elementary functions beside the C library's: time and error.
#pragma once

#include <string>
#include <vector>

#include "timing.hpp"

namespace impact_damper::bench {

struct FunctionCost {
  std::string name, arguments;
  // Seconds of a call in a chain in which each waits for the one before: with the product and the sum by
  // which it does.
  Spread own, library;
  Spread ratio;  // of repeats taken in turn
  // The largest of the chain's arguments, in units of the last place, by the C library's long double.
  double own_error = 0, library_error = 0;
};
std::vector<FunctionCost> measure_functions(int repeats);

}  // namespace impact_damper::bench
