// The wording in which bad input is rejected, the same for files and command lines.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace impact_damper {

// The range of allowed numbers, both limits included unless least_is_allowed is false. NaN never is allowed.
struct NumberRange {
  double least = std::numeric_limits<double>::lowest();
  double most = std::numeric_limits<double>::max();
  bool least_is_allowed = true;

  bool allows(double value) const;
  bool allows(std::int64_t value) const;              // exactly: above 2^53 not every integer is a double
  std::string describe(std::string_view kind) const;  // "a number" -> "a number >= 0 and <= 1"
};
constexpr NumberRange within(double least, double most) { return {least, most}; }
constexpr NumberRange at_least(double least) { return {least}; }
constexpr NumberRange above(double least) { return {least, std::numeric_limits<double>::max(), false}; }

// A kind of file, and its largest allowed size.
struct FileKind {
  std::string_view name;  // "scene"
  std::size_t most_bytes;
};

bool is_utf8(std::string_view text);
// Returns the parts of `text` between these characters, at least one: of "a,,b" "a", "" and "b".
std::vector<std::string_view> parts_of(std::string_view text, char between = ',');
// Returns `text` on one line of UTF-8, with a question mark for each byte that is no character and each
// control character. If it is longer than `most` characters: its first `most`, then "...".
std::string cut(std::string_view text, std::size_t most = 60);
std::string in_quotes(std::string_view text);  // cut, between double quotes
// "a", "a or b", "a, b or c"; `last` is the word before the final item, here "or".
std::string listed(const std::vector<std::string_view>& words, std::string_view last);

std::string in_lower_case(std::string_view text);  // ASCII

// Returns the word of `known` that `word` most likely means: the name of the symbol `word` (nu: mass_ratio),
// else the nearest if it is near enough, else the first one with a part that begins with `word` (force:
// exciting_force). Options and keys count as the same, "--mass-ratio" as "mass_ratio"; capitals decide only
// between words that are equally near without them. A word that ends in a unit means none with another or
// without one: x_cm is not x_mm. Absent if there is none.
std::optional<std::string_view> nearest(std::string_view word, const std::vector<std::string_view>& known);
// Returns ", did you mean WORD?" with that word, between quotes if they are given; "" if there is none. Where
// `word` is the last part of several, these: "frequency" is natural_frequency or exciting_frequency.
std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known,
                         std::string_view quote = "");

}  // namespace impact_damper
