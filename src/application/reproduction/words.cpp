#include "application/reproduction/words.hpp"

#include <cmath>
#include <stdexcept>

#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {
namespace {

struct Field {
  std::string name, form;
  std::size_t end;  // after the closing brace
};

// Returns the field that opens at `open`. Throws std::invalid_argument if it does not close.
Field field_at(std::string_view words, std::size_t open) {
  const std::size_t close = words.find('}', open);
  if (close == std::string_view::npos) throw std::invalid_argument("has a { without }");
  const std::string_view inner = words.substr(open + 1, close - open - 1);
  const std::size_t bar = inner.find('|');
  return {std::string(inner.substr(0, bar)),
          bar == std::string_view::npos ? std::string() : std::string(inner.substr(bar + 1)), close + 1};
}

// Returns the N of "of N"; absent for another form.
std::optional<std::int64_t> count_of(const std::string& form) {
  if (!form.starts_with("of ")) return std::nullopt;
  const auto count = parse_integer(std::string_view(form).substr(3));
  return count && *count > 0 ? count : std::nullopt;
}

std::string bracketed(const std::string& median, const std::string& low, const std::string& high,
                      const std::string& unit) {
  if (low == median && high == median) return median + unit;
  return median + unit + " (" + low + " to " + high + unit + ")";
}

// Format of a field's number: its factor, significant digits and unit.
struct Written {
  double factor = 1;
  int digits = 4;
  std::string unit;
};
Written written_as(const std::string& form) {
  if (form == "%") return {100, 3, " %"};
  if (form == "percent") return {1, 4, " %"};
  if (form == "degrees") return {1, 4, " degrees"};
  return {};
}

// Returns a count as text: the three numbers of the spread are rounded to whole ones.
std::string counted(const Spread& spread, std::optional<std::int64_t> of) {
  if (!std::isfinite(spread.median)) return "none";
  const auto text = [&](double value) {
    const auto whole = static_cast<std::int64_t>(std::llround(of ? value * static_cast<double>(*of) : value));
    if (!of) return whole == 0 ? std::string("no") : std::to_string(whole);
    if (whole == *of) return "all " + std::to_string(whole);
    return (whole == 0 ? "none" : std::to_string(whole)) + " of " + std::to_string(*of);
  };
  return bracketed(text(spread.median), text(spread.low), text(spread.high), "");
}

std::string field_text(const Field& field, const Spread& spread) {
  if (field.form == "count") return counted(spread, std::nullopt);
  if (const auto count = count_of(field.form)) return counted(spread, count);
  if (!std::isfinite(spread.median)) return "none";
  const Written how = written_as(field.form);
  const auto text = [&](double value) {
    return std::isfinite(value) ? rounded_text(how.factor * value + 0.0, how.digits)  // no -0
                                : std::string("none");
  };
  return bracketed(text(spread.median), text(spread.low), text(spread.high), how.unit);
}

// Returns the form of the first field that is the claim's own number; empty if there is none.
std::string own_form(std::string_view words) {
  for (std::size_t open = words.find('{'); open != std::string_view::npos;) {
    const Field field = field_at(words, open);
    if (field.name.empty()) return field.form;
    open = words.find('{', field.end);
  }
  return {};
}

}  // namespace

std::optional<std::string> problem_of_words(std::string_view words,
                                            const std::set<std::string, std::less<>>& names, Fields fields) {
  bool has_field = false;
  for (std::size_t open = words.find('{'); open != std::string_view::npos;) {
    if (words.find('}', open) == std::string_view::npos) return "has a { without }";
    const Field field = field_at(words, open);
    has_field = true;
    if (!field.name.empty() && !names.contains(field.name))
      return "must name a measure of \"also\" in braces, got " + in_quotes(field.name);
    if (!field.form.empty() && field.form != "count" && !count_of(field.form) &&
        written_as(field.form).unit.empty())
      return "must have %, percent, degrees, count or of N behind the bar, got " + in_quotes(field.form);
    open = words.find('{', field.end);
  }
  if (!has_field && fields == Fields::needed)
    return "must show what is measured, {}, got none in " + in_quotes(words);
  return std::nullopt;
}

std::string in_words(std::string_view words, const NamedSpreads& spreads) {
  std::string text;
  std::size_t behind = 0;
  for (std::size_t open = words.find('{'); open != std::string_view::npos; open = words.find('{', behind)) {
    const Field field = field_at(words, open);
    const auto spread = spreads.find(field.name);
    if (spread == spreads.end()) throw std::invalid_argument("words: nothing is measured as " + field.name);
    text.append(words, behind, open - behind);
    text += field_text(field, spread->second);
    behind = field.end;
  }
  return text.append(words.substr(behind));
}

std::string allowed_in_words(std::string_view words, const Allowed& allowed) {
  const std::string form = own_form(words);
  const auto& [least, most] = allowed.printed;
  const bool is_one = least && most && *least == *most;
  if (is_one && count_of(form) && allowed.above == 0)
    return field_text({{}, form, 0}, {*least, *least, *least});
  Written how = written_as(form);
  how.digits = 4;
  if (count_of(form)) how = {100, 4, " %"};
  const auto text = [&](double value) { return rounded_text(how.factor * value + 0.0, how.digits); };
  if (is_one) return text(*least) + (allowed.above > 0 ? " +- " + text(allowed.above) : "") + how.unit;
  if (least && most) return text(*least - allowed.below) + " to " + text(*most + allowed.above) + how.unit;
  return (least ? ">= " + text(*least - allowed.below) : "<= " + text(*most + allowed.above)) + how.unit;
}

}  // namespace impact_damper
