// The errors outside the mathematics, each kind of which has an exit code of its own in the program; and
// results of steps that can fail.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
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

// The result of a step that can fail, or the reason why there is none. The caller must check first whether
// there is a result: reading one that is not there throws std::bad_variant_access, as does asking for a
// failure that did not happen.
template <class Value, class Failure>
class Expected {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor)
  Expected(Value value) : content_(std::move(value)) {}  // cppcheck-suppress noExplicitConstructor
  // NOLINTNEXTLINE(google-explicit-constructor)
  Expected(Failure failure) : content_(std::move(failure)) {}  // cppcheck-suppress noExplicitConstructor

  explicit operator bool() const { return std::holds_alternative<Value>(content_); }
  const Value& operator*() const& { return std::get<Value>(content_); }
  Value& operator*() & { return std::get<Value>(content_); }
  Value&& operator*() && { return std::get<Value>(std::move(content_)); }
  const Value* operator->() const { return &**this; }
  Value* operator->() { return &**this; }
  const Failure& failure() const { return std::get<Failure>(content_); }

 private:
  std::variant<Value, Failure> content_;
};

}  // namespace impact_damper
