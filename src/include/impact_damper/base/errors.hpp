// The errors outside the mathematics: each kind has an exit code of its own in the program.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace impact_damper {

// A problem with one field of a scene, option, or entry of a file: "mass_ratio", "must be ..., got ...".
struct Problem {
  std::string field;  // "" if it is about the whole
  std::string message;
};
// The JSON pointer of a field: "/dampers/2/clearance" for "dampers[2].clearance", "" for "".
std::string pointer_of(std::string_view field);
// Each problem as one line, "FIELD: MESSAGE", with `head` before it.
std::vector<std::string> lines_of(const std::vector<Problem>& problems, const std::string& head = {});

// Arguments of a function are not valid. problems() names their fields; what() has a line for each problem.
class InvalidArguments : public std::invalid_argument {
 public:
  explicit InvalidArguments(std::vector<Problem> problems);
  const std::vector<Problem>& problems() const { return problems_; }

 private:
  std::vector<Problem> problems_;
};

// Throws InvalidArguments if there are any.
void require_none(const std::vector<Problem>& problems);

// A file that was read but whose content is not valid. Each problem is one whole line,
// "FILE: /json/pointer: what is wrong, what is allowed, what was given"; what() joins them.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<std::string> problems);
  InputError(const std::string& file, const std::vector<Problem>& problems);  // fields: JSON pointers
  const std::vector<std::string>& problems() const { return problems_; }

 private:
  std::vector<std::string> problems_;
};

// A result that is not finite, or arithmetic that cannot give the promised bits (floating_point.hpp). what()
// is one line.
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
