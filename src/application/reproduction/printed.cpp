#include "application/reproduction/printed.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

constexpr std::optional<double> none = std::nullopt;

double value_of(const std::string& digits) {
  const auto value = parse_number(digits);
  if (!value || !last_digit(digits))
    throw std::invalid_argument("must be a number as printed, digits with at most one point, got \"" +
                                digits + "\"");
  return *value;
}

// Returns `units` of the last digit of a number, at most a tenth of the number.
double tolerance_of(const std::string& digits, double units) {
  return std::min(units * *last_digit(digits), value_of(digits) / 10);
}

}  // namespace

const std::vector<PrintedKind>& printed_kinds() {
  static const std::vector<PrintedKind> table{
      {"number", 1, {}, "A number as printed: half a unit of its last digit, at most a tenth of the number."},
      {"approximate",
       1,
       {},
       "Approximately a number: a unit of its last digit, at most a tenth of the number."},
      {"range", 2, {}, "A range: at each end a unit of its last digit, at most a tenth of the number."},
      {"at_least",
       1,
       {},
       "A bound as printed: half a unit of its last digit, at most a tenth of the number."},
      {"at_most", 1, {}, "A bound as printed: half a unit of its last digit, at most a tenth of the number."},
      {"count", 1, {}, "A count: nothing to round."},
      {"all", 0, {1, 1}, "Every one, so a share of 1."},
      {"mostly", 0, {0.5, 1}, "More often than not, so a share of a half at least."},
      {"some", 0, {0.05, 0.95}, "Some but not all: a share of 5 to 95 percent."},
      {"more", 0, {1.01, none}, "More than the other: a ratio above 1, by a percent at least."},
      {"less", 0, {none, 0.99}, "Less than the other: a ratio below 1, by a percent at least."},
      {"rises", 0, {0, none}, "It rises: a slope above 0."},
      {"falls", 0, {none, 0}, "It falls: a slope below 0."},
      {"proportional", 0, {0.9, 1.1}, "Proportional: an exponent of 1, a tenth to either side."},
      {"nearly_one_curve", 0, {0, 10}, "Nearly one curve: a mean spread of a tenth."},
      {"same_curve",
       0,
       {0, 3},
       "The same but for chaos, which moves curves by up to 1 percent: three times that."},
      {"small", 0, {-0.1, 0.1}, "Small or close beside another: at most a tenth of it."},
      {"large_number", 0, {10, none}, "A large number: ten at least."},
      {"wide", 0, {3, none}, "A wide range: a factor of three at least, half a decade."},
      {"equal_angles", 0, {0, 5}, "Equal in a figure: 5 degrees at most."},
      {"unequal_angles", 0, {5, none}, "Unequal in a figure: 5 degrees at least."},
  };
  return table;
}

std::optional<double> last_digit(std::string_view digits) {
  const std::size_t point = digits.find('.');
  const std::size_t last =
      point == std::string_view::npos ? digits.find_last_not_of('0') : digits.find_last_not_of('.');
  if (digits.empty() || digits.find_first_not_of("0123456789.") != std::string_view::npos ||
      digits.find_first_of("123456789") == std::string_view::npos ||
      digits.find('.', point + 1) < digits.size() || !parse_number(digits))
    return std::nullopt;
  std::string unit(digits);
  for (std::size_t i = 0; i < unit.size(); ++i)
    if (unit[i] != '.') unit[i] = i == last ? '1' : '0';
  unit.erase(0, std::min(unit.find_first_not_of('0'), unit.size()));
  return parse_number(unit.starts_with('.') ? '0' + unit : unit);
}

Allowed allowed_by(const PrintedKind& kind, const std::vector<std::string>& digits) {
  if (digits.size() != kind.digits)
    throw std::invalid_argument("must be " + std::to_string(kind.digits) + " numbers as printed, got " +
                                std::to_string(digits.size()));
  Allowed allowed{.printed = kind.interval, .reason = std::string(kind.reason)};
  if (digits.empty()) return allowed;
  const double first = value_of(digits.front()), last = value_of(digits.back());
  if (!(first <= last)) throw std::invalid_argument("must ascend");
  allowed.printed = {first, last};
  if (kind.name == "number") {
    allowed.below = allowed.above = tolerance_of(digits[0], 0.5);
  } else if (kind.name == "approximate" || kind.name == "range") {
    allowed.below = tolerance_of(digits.front(), 1);
    allowed.above = tolerance_of(digits.back(), 1);
  } else if (kind.name == "at_least") {
    allowed.printed.most = none;
    allowed.below = tolerance_of(digits[0], 0.5);
  } else if (kind.name == "at_most") {
    allowed.printed.least = none;
    allowed.above = tolerance_of(digits[0], 0.5);
  }
  return allowed;
}

}  // namespace impact_damper
