// The interval that a result must lie in, from what the paper prints: one rule for all claims. It depends on
// the printed digits or word alone, never on the result found here.
//
//   a number              half a unit of its last digit to either side: what rounding leaves open
//   "approximately" it    a whole unit to either side, and so of "about" and "nearly" it
//   a range               the same at each end
//   a bound               half a unit on the side of the bound; open on the other
//   a count               no tolerance
//   a word                the same interval wherever the word, or one that says the same, is used
//
// No number allows more than a tenth of itself, so that what is printed with one digit is not held more
// loosely than what is printed with two. A tenth is also what "proportional", "nearly one curve" and "small"
// allow.
//
// The last digit of a whole number is the last that is not zero: "31" is of two digits, "10" of one.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace impact_damper {

struct Interval {  // both ends included; absent: none
  std::optional<double> least, most;
};

struct PrintedKind {
  std::string_view name;
  std::size_t digits;       // how many printed numbers it takes
  Interval interval;        // of a word; empty for numbers
  std::string_view reason;  // why the interval is what it is
};
const std::vector<PrintedKind>& printed_kinds();

// Returns the unit of the last digit of a number as printed, "0.339" -> 0.001, "31" -> 1, "10" -> 10. Absent
// if the text is not digits with at most one point among them, or all of them are zero.
std::optional<double> last_digit(std::string_view digits);

// The interval that a printed value allows: the value (or both ends of the range) before the tolerance, the
// tolerance at each end, and its reason.
struct Allowed {
  Interval printed;
  double below = 0, above = 0;  // tolerances, >= 0
  std::string reason;
};
// Returns it for `digits`: as many as the kind takes, each with a last_digit(), a range ascending. Throws
// std::invalid_argument otherwise.
Allowed allowed_by(const PrintedKind& kind, const std::vector<std::string>& digits);

}  // namespace impact_damper
