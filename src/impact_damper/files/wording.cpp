#include "impact_damper/files/wording.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "impact_damper/files/number_text.hpp"

namespace impact_damper {
namespace {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i] != b[j]);
      diagonal = row[j + 1];
      row[j + 1] = std::min({changed, row[j] + 1, diagonal + 1});
    }
  }
  return row.back();
}

// How many bytes the UTF-8 character at the front of `text` has; 0 if none stands there. Overlong forms and
// surrogates, which are none either, print as they are.
std::size_t character_length(std::string_view text) {
  const auto first = static_cast<unsigned char>(text[0]);
  const std::size_t length = first < 0x80   ? 1
                             : first < 0xc2 ? 0
                             : first < 0xe0 ? 2
                             : first < 0xf0 ? 3
                             : first < 0xf5 ? 4
                                            : 0;
  if (length > text.size()) return 0;
  for (std::size_t i = 1; i < length; ++i) {
    if ((static_cast<unsigned char>(text[i]) & 0xc0) != 0x80) return 0;
  }
  return length;
}

}  // namespace

bool NumberRange::admits(double value) const {
  return (least_is_admitted ? value >= least : value > least) && value <= most;
}

std::string NumberRange::describe(std::string_view kind) const {
  std::string text(kind);
  const bool bounded_below = least > std::numeric_limits<double>::lowest();
  const bool bounded_above = most < std::numeric_limits<double>::max();
  if (bounded_below) text += (least_is_admitted ? " >= " : " > ") + number_text(least);
  if (bounded_below && bounded_above) text += " and";
  if (bounded_above) text += " <= " + number_text(most);
  return text;
}

std::string cut(std::string_view text, std::size_t most) {
  std::string line;
  std::size_t at = 0;
  for (std::size_t characters = 0; at < text.size() && characters < most; ++characters) {
    const std::size_t length = character_length(text.substr(at));
    const bool is_control = static_cast<unsigned char>(text[at]) < 0x20 || text[at] == 0x7f;
    line += length == 0 || is_control ? "?" : text.substr(at, length);
    at += std::max<std::size_t>(length, 1);
  }
  return at < text.size() ? line + "..." : line;
}

std::string in_quotes(std::string_view text) { return '"' + cut(text) + '"'; }

std::optional<std::string_view> nearest(std::string_view word, const std::vector<std::string_view>& known) {
  if (word.size() > 100) return std::nullopt;
  std::optional<std::string_view> found;
  // Two slips, or one in every three letters of a long word; farther words are not what was meant.
  std::size_t best = std::max<std::size_t>(2, word.size() / 3) + 1;
  for (const std::string_view candidate : known) {
    const std::size_t distance = edit_distance(word, candidate);
    if (distance >= best || distance >= candidate.size()) continue;
    best = distance;
    found = candidate;
  }
  return found;
}

}  // namespace impact_damper
