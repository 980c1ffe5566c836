// What can go wrong outside the mathematics: each kind has an exit code of its own in the program.
#pragma once

#include <stdexcept>
#include <string>
#include <vector>

namespace impact_damper {

// A file that was read but whose content is not valid. Each problem is one whole line,
// "FILE: /json/pointer: what is wrong, what is allowed, what was given"; what() joins them.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<std::string> problems);
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

// A computation that went astray: a result that is not finite. what() is one line.
class NumericalError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// A file or folder that cannot be read or written. what() is one line that begins with its name.
class IoError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace impact_damper
