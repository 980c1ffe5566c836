// A computation that went where no number is: an unstable run that overflowed.
#pragma once

#include <stdexcept>

namespace impact_damper {

class NumericalFailure : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace impact_damper
