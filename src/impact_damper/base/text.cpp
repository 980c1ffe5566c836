#include "impact_damper/base/text.hpp"

#include <algorithm>
#include <array>
#include <numeric>
#include <utility>

#include "impact_damper/base/number_text.hpp"

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

// Returns an option or a key without the marks of either: "--mass-ratio" and "mass_ratio" are "mass_ratio".
std::string bare(std::string_view word) {
  word.remove_prefix(std::min(word.find_first_not_of('-'), word.size()));
  std::string name(word);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
}

// The symbols of docs/mathematics.md and their names at the interface, first the dimensionless ones, then
// those with units; and words that have another name elsewhere.
constexpr std::array<std::pair<std::string_view, std::string_view>, 30> symbols{
    {{"nu", "mass_ratio"},
     {"e", "restitution"},
     {"zeta", "damping_ratio"},
     {"k", "wall_stiffness"},
     {"k", "contact_stiffness"},
     {"x", "x0"},
     {"v", "v0"},
     {"y", "y0"},
     {"w", "w0"},
     {"f0", "force_amplitude"},
     {"f0", "exciting_force"},
     {"F0", "exciting_force"},
     {"omega_f", "force_frequency"},
     {"omega_f", "exciting_frequency"},
     {"omega", "force_frequency"},
     {"omega", "exciting_frequency"},
     {"M", "mass"},
     {"m", "secondary_mass"},
     {"K", "stiffness"},
     {"C", "damping"},
     {"phi", "friction"},
     {"mu", "friction_coefficient"},
     {"gamma", "weight"},
     {"epsilon", "clearance"},
     {"gap", "clearance"},
     {"h", "time_step"},
     // Options of the command line and keys of plans.
     {"vary", "grid"},
     {"grid", "vary"},
     {"keep", "quantities"},
     {"quantities", "keep"}}};

// Returns the words for the unit that a bare name in lower case ends in, those for "mm" of "x_mm" and
// "until_millimeters"; "" if none.
std::string_view unit_at_end(std::string_view name) {
  constexpr auto units = std::to_array<std::string_view>(
      {" m metre metres meter meters ", " mm millimetre millimetres millimeter millimeters ",
       " cm centimetre centimetres centimeter centimeters ", " um micrometres micrometers ",
       " in inch inches ", " s sec second seconds ", " ms millisecond milliseconds ", " min minute minutes ",
       " h hour hours ", " kg ", " g ", " n ", " hz ", " deg ", " rad "});
  const std::size_t end = name.rfind('_');
  if (end == std::string_view::npos) return {};
  const std::string word = ' ' + std::string(name.substr(end + 1)) + ' ';
  for (const std::string_view each : units)
    if (each.find(word) != std::string_view::npos) return each;
  return {};
}

// Whether `word` begins one of the parts of `name` between underscores: "force" in "exciting_force".
bool begins_a_part(std::string_view word, std::string_view name) {
  for (std::size_t at = name.find(word); at != std::string_view::npos; at = name.find(word, at + 1))
    if (at == 0 || name[at - 1] == '_') return true;
  return false;
}

// Returns the number of bytes of the UTF-8 character at the front of `text`; 0 if there is none. Overlong
// forms and surrogates are no characters, but print as they are.
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

// Returns -1, 0 or 1 as `value` is below, equal to or above `limit`. Rounding `value` to a double keeps its
// order with another double, so the integers are compared only where it becomes `limit` itself.
int order(std::int64_t value, double limit) {
  const auto rounded = static_cast<double>(value);
  if (rounded != limit || rounded == 0x1p63) return rounded > limit ? 1 : -1;
  const auto exact = static_cast<std::int64_t>(limit);
  return (value > exact) - (value < exact);
}

}  // namespace

bool NumberRange::allows(double value) const {
  return (least_is_allowed ? value >= least : value > least) && value <= most;
}

bool NumberRange::allows(std::int64_t value) const {
  const int above_least = order(value, least);
  return (least_is_allowed ? above_least >= 0 : above_least > 0) && order(value, most) <= 0;
}

std::string NumberRange::describe(std::string_view kind) const {
  std::string text(kind);
  const bool bounded_below = least > std::numeric_limits<double>::lowest();
  const bool bounded_above = most < std::numeric_limits<double>::max();
  if (bounded_below) text += (least_is_allowed ? " >= " : " > ") + number_text(least);
  if (bounded_below && bounded_above) text += " and";
  if (bounded_above) text += " <= " + number_text(most);
  return text;
}

std::vector<std::string_view> parts_of(std::string_view text, char between) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(between, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

bool is_utf8(std::string_view text) {
  while (!text.empty()) {
    const std::size_t length = character_length(text);
    if (length == 0) return false;
    text.remove_prefix(length);
  }
  return true;
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

std::string listed(const std::vector<std::string_view>& words, std::string_view last) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 < words.size() ? ", " : ' ' + std::string(last) + ' ';
    text += words[i];
  }
  return text;
}

std::string in_lower_case(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

std::optional<std::string_view> nearest(std::string_view word, const std::vector<std::string_view>& known) {
  if (word.size() > 100) return std::nullopt;
  const std::string as_given = bare(word), asked = in_lower_case(as_given);
  if (asked.empty()) return std::nullopt;
  std::vector<std::string_view> candidates = known;
  if (const std::string_view unit = unit_at_end(asked); !unit.empty())
    std::erase_if(candidates,
                  [&](std::string_view each) { return unit_at_end(in_lower_case(bare(each))) != unit; });
  for (const auto& [symbol, name] : symbols) {
    if (as_given != symbol) continue;
    for (const std::string_view candidate : candidates)
      if (bare(candidate) == name) return candidate;
  }
  // A name that was cut off.
  if (asked.size() >= 4)
    for (const std::string_view candidate : candidates)
      if (in_lower_case(bare(candidate)).starts_with(asked)) return candidate;
  std::optional<std::string_view> found;
  // At most two slips, or one in every three letters of a long word, but no more than half of a short one.
  std::pair<std::size_t, std::size_t> best{
      std::min(std::max<std::size_t>(2, asked.size() / 3), (asked.size() + 1) / 2) + 1, 0};
  for (const std::string_view candidate : candidates) {
    const std::string name = bare(candidate);
    const std::pair distance{edit_distance(asked, in_lower_case(name)), edit_distance(as_given, name)};
    if (distance >= best || distance.first >= name.size()) continue;
    best = distance;
    found = candidate;
  }
  if (found || asked.size() < 3) return found;
  for (const std::string_view candidate : candidates)
    if (begins_a_part(asked, in_lower_case(bare(candidate)))) return candidate;
  return std::nullopt;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string_view>& known,
                         std::string_view quote) {
  std::string meant;
  const auto add = [&](std::string_view each) {
    meant.append(meant.empty() ? "" : " or ").append(quote).append(each).append(quote);
  };
  const std::string asked = '_' + in_lower_case(bare(word));
  for (const std::string_view each : known)
    if (in_lower_case(bare(each)).ends_with(asked)) add(each);
  if (meant.find(' ') == std::string::npos) {
    meant.clear();
    if (const auto one = nearest(word, known)) add(*one);
  }
  return meant.empty() ? "" : ", did you mean " + meant + "?";
}

}  // namespace impact_damper
