#include "application/reproduction/claims.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <set>
#include <stdexcept>

#include "application/reproduction/measures.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/io/json_reader.hpp"

namespace impact_damper {
namespace {

// The fields of a template, each with the text before it, and the text after the last one, in which there
// is a "{" if that one does not close.
struct Field {
  std::string_view before;
  std::string name, form;
};
struct Template {
  std::vector<Field> fields;
  std::string_view rest;
};
Template template_of(std::string_view words) {
  Template parts;
  for (;;) {
    const std::size_t open = words.find('{'), close = words.find('}', open);
    if (open == std::string_view::npos || close == std::string_view::npos) break;
    const std::string_view inner = words.substr(open + 1, close - open - 1);
    const std::size_t bar = std::min(inner.find('|'), inner.size());
    parts.fields.push_back({words.substr(0, open), std::string(inner.substr(0, bar)),
                            std::string(inner.substr(std::min(bar + 1, inner.size())))});
    words.remove_prefix(close + 1);
  }
  parts.rest = words;
  return parts;
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

std::string field_text(const std::string& form, const Spread& spread) {
  if (form == "count") return counted(spread, std::nullopt);
  if (const auto count = count_of(form)) return counted(spread, count);
  if (!std::isfinite(spread.median)) return "none";
  const Written how = written_as(form);
  const auto text = [&](double value) {
    return std::isfinite(value) ? rounded_text(how.factor * value + 0.0, how.digits)  // no -0
                                : std::string("none");
  };
  return bracketed(text(spread.median), text(spread.low), text(spread.high), how.unit);
}

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

Interval read_interval(ObjectReader& object, std::string_view key) {
  std::vector<std::optional<double>> ends;
  if (!object.optional(key, ends)) return {};
  if (ends.size() != 2 || (!ends[0] && !ends[1]) || (ends[0] && ends[1] && !(*ends[0] <= *ends[1]))) {
    std::string given;
    for (const auto& end : ends) given += (given.empty() ? "" : ", ") + (end ? number_text(*end) : "null");
    object.reject(
        key, "must be [least, most], at least one of them a number, least <= most, got [" + cut(given) + "]");
    return {};
  }
  return {ends[0], ends[1]};
}

MeasureCall read_measure(ObjectReader object) {
  MeasureCall call;
  std::vector<std::string_view> names;
  for (const Measure& measure : measures()) names.push_back(measure.name);
  const auto index = object.require("name") ? object.word("name", names) : std::nullopt;
  if (!index) {
    object.keys();  // whatever else is there belongs to a measure that is not known
    return call;
  }
  const Measure& measure = measures()[*index];
  call.name = measure.name;
  const auto read_names = [&](const std::string& key, const Count& count, std::vector<std::string>& into) {
    if (count.most == 0 || !object.required(key, into, a_name, count.most) || into.size() >= count.least)
      return;
    const std::string at_least =
        count.least == count.most ? "exactly " : std::to_string(count.least) + " to ";
    object.reject(key, "must name " + at_least + std::to_string(count.most) + " " +
                           (count.most == 1 ? key.substr(0, key.size() - 1) : key) + ", got " +
                           std::to_string(into.size()));
  };
  read_names("scenes", measure.scenes, call.scenes);
  read_names("responses", measure.responses, call.responses);
  for (const std::string_view number : measure.numbers) {
    double value = 0;
    if (!object.required(number, value)) continue;
    const MeasureNumber& rule = measure_number(number);
    if (rule.allows(value)) {
      call.numbers[std::string(number)] = value;
    } else {
      const char* const kind = rule.multiple_of == 0   ? "a number"
                               : rule.multiple_of == 1 ? "a whole number"
                                                       : "an even number";
      object.reject(number, "must be " + rule.range.describe(kind) + ", got " + number_text(value));
    }
  }
  const auto from = call.numbers.find("from"), to = call.numbers.find("to");
  if (from != call.numbers.end() && to != call.numbers.end() && !(from->second < to->second)) {
    object.reject(
        "to", "must be above \"from\", " + number_text(from->second) + ", got " + number_text(to->second));
  }
  return call;
}

bool agrees(Verdict verdict) { return verdict == Verdict::reproduced || verdict == Verdict::holds; }
bool is_of_ours(Verdict verdict) { return verdict == Verdict::holds || verdict == Verdict::does_not_hold; }

// Reads what is allowed: by the kind of what is printed, or a value or range with a tolerance of its own.
Allowed read_allowed(ObjectReader& object) {
  Allowed allowed;
  if (object.has("kind")) {
    std::vector<std::string_view> names;
    for (const PrintedKind& kind : printed_kinds()) names.push_back(kind.name);
    const auto index = object.word("kind", names);
    std::vector<std::string> digits;
    const bool is_read = object.optional("digits", digits, TextRule{1, 20}, 2);
    if (!index || !is_read) return allowed;
    try {
      return allowed_by(printed_kinds()[*index], digits);
    } catch (const std::invalid_argument& problem) {
      object.reject("digits", problem.what());
    }
    return allowed;
  }
  if (object.has("value") == object.has("range")) {
    object.reject("value", R"(one of it, "range" and "kind" must be given, got )" +
                               std::string(object.has("value") ? "both" : "none"));
  }
  if (object.has("value")) {
    double value = 0;
    object.optional("value", value);
    allowed.printed = {value, value};
  } else {
    allowed.printed = read_interval(object, "range");
  }
  object.required("tolerance", allowed.below, at_least(0));
  allowed.above = allowed.below;
  object.required("reason", allowed.reason, some_text);
  return allowed;
}

using Names = std::set<std::string, std::less<>>;  // of the numbers that a claim measures beside its own

void read_words(ObjectReader& object, Claim& claim, Names& names) {
  if (auto also = object.optional_object("also")) {
    for (const std::string& name : also->keys()) {
      claim.also[name] = read_measure(also->required_object(name));
      names.insert(name);
      if (!a_name.allows(name)) also->reject(name, "its key must be " + a_name.describe());
    }
  }
  if (!object.optional("words", claim.words, some_text)) return;
  if (const auto problem = problem_of_words(claim.words, names, Fields::needed))
    object.reject("words", *problem);
}

void require_explanation(ObjectReader& object, std::string_view key, std::string& text, const Names& names) {
  if (!object.required(key, text, some_text)) return;
  if (const auto problem = problem_of_words(text, names, Fields::allowed)) object.reject(key, *problem);
}

void read_statement(ObjectReader& object, Statement& statement) {
  object.required("id", statement.id, a_name);
  object.required("section", statement.section, some_text);
  object.required("statement", statement.statement, some_text);
  object.required("printed", statement.printed, some_text);
}

Claim read_claim(ObjectReader& object) {
  Claim claim;
  read_statement(object, claim);
  object.optional("source", claim.source);
  claim.allowed = read_allowed(object);
  claim.measure = read_measure(object.required_object("measure"));
  Names names;
  read_words(object, claim, names);
  if (object.has("corrected")) claim.corrected = read_interval(object, "corrected");
  const bool recorded = object.required("verdict", claim.recorded);
  if (auto engines = object.optional_object("with_engine")) {
    for (const std::string_view engine : engine_names()) {
      auto otherwise = engines->optional_object(engine);
      if (!otherwise) continue;
      Claim::Otherwise& read = claim.with_engine[std::string(engine)];
      otherwise->required("verdict", read.recorded);
      require_explanation(*otherwise, "explanation", read.explanation, names);
    }
  }
  if (!recorded) {
    for (const std::string_view key : {"corrected", "explanation", "evidence"}) object.has(key);
    return claim;  // which of them belong there depends on the verdict
  }
  if (is_of_ours(claim.recorded) != (claim.source == Source::ours))
    object.reject("verdict",
                  R"(must be "holds" or "does not hold" if, and only if, the source is "ours", got )" +
                      in_quotes(name_of(claim.recorded)) + " with " + in_quotes(name_of(claim.source)));
  if (!agrees(claim.recorded)) {
    require_explanation(object, "explanation", claim.explanation, names);
    if (claim.recorded != Verdict::derived) require_explanation(object, "evidence", claim.evidence, names);
  }
  const bool corrected = object.has("corrected");
  if ((claim.recorded == Verdict::corrected) != corrected) {
    object.reject("corrected", "must be given if, and only if, the verdict is \"corrected\", got " +
                                   std::string(corrected ? "it" : "none") + " with " +
                                   in_quotes(name_of(claim.recorded)));
  }
  return claim;
}

ClaimsFile read_document(JsonDocument document) {
  ObjectReader root = document.root();
  root.word("schema", {"impact-damper/claims/1"});
  root.require("schema");
  ClaimsFile file;
  std::set<std::string> ids;
  const auto once = [&](ObjectReader& object, const std::string& id) {
    if (!id.empty() && !ids.insert(id).second)
      object.reject("id", "must be given once, got the string " + in_quotes(id));
  };
  constexpr std::size_t most = 10000;
  for (ObjectReader object : root.required_objects("claims", most)) {
    file.claims.push_back(read_claim(object));
    once(object, file.claims.back().id);
  }
  for (ObjectReader object : root.optional_objects("open", most)) {
    OpenStatement& open = file.open.emplace_back();
    read_statement(object, open);
    object.required("explanation", open.explanation, some_text);
    once(object, open.id);
  }
  document.finish();
  return file;
}

}  // namespace

const std::vector<PrintedKind>& printed_kinds() {
  constexpr Interval number{};
  constexpr std::string_view bound =
      "A bound as printed: half a unit of its last digit, at most a tenth of the number.";
  static const std::vector<PrintedKind> table{
      {"number", 1, number,
       "A number as printed: half a unit of its last digit, at most a tenth of the number.", 0.5},
      {"approximate", 1, number,
       "Approximately a number: a unit of its last digit, at most a tenth of the number.", 1},
      {"range", 2, number, "A range: at each end a unit of its last digit, at most a tenth of the number.",
       1},
      {"at_least", 1, number, bound, 0.5},
      {"at_most", 1, number, bound, 0.5},
      {"count", 1, number, "A count: nothing to round."},
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
      {"insignificant", 0, {0, 0.05}, "Insignificant beside the rest: a share of a twentieth at most."},
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
  if (kind.name == "at_least")
    allowed.printed.most = none;
  else
    allowed.above = tolerance_of(digits.back(), kind.units);
  if (kind.name == "at_most")
    allowed.printed.least = none;
  else
    allowed.below = tolerance_of(digits.front(), kind.units);
  return allowed;
}

std::string_view name_of(Verdict verdict) {
  constexpr std::array<std::string_view, 6> names{"reproduced", "not reproduced", "corrected",
                                                  "derived",    "holds",          "does not hold"};
  return names.at(static_cast<std::size_t>(verdict));
}

ClaimsFile read_claims(const std::filesystem::path& file) {
  return read_document(JsonDocument::read(file, claims_kind));
}
ClaimsFile parse_claims(const std::string& name, const std::string& text) {
  return read_document(JsonDocument::parse(name, text));
}

Verdict recorded_for(const Claim& claim, std::string_view engine) {
  const auto otherwise = claim.with_engine.find(engine);
  return otherwise == claim.with_engine.end() ? claim.recorded : otherwise->second.recorded;
}

Verdict judge(const Claim& claim, double ours) {
  const auto lies_in = [&](const Interval& interval, double below, double above) {
    if (!(ours == ours)) return false;
    return !(interval.least && !(ours >= *interval.least - below)) &&
           !(interval.most && !(ours <= *interval.most + above));
  };
  const Allowed& allowed = claim.allowed;
  const bool is_allowed = lies_in(allowed.printed, allowed.below, allowed.above);
  if (claim.source == Source::ours) return is_allowed ? Verdict::holds : Verdict::does_not_hold;
  if (is_allowed) return claim.recorded == Verdict::derived ? Verdict::derived : Verdict::reproduced;
  if (claim.corrected && lies_in(*claim.corrected, 0, 0)) return Verdict::corrected;
  return Verdict::not_reproduced;
}

std::optional<std::string> problem_of_words(std::string_view words,
                                            const std::set<std::string, std::less<>>& names, Fields fields) {
  const Template parts = template_of(words);
  for (const Field& field : parts.fields) {
    if (!field.name.empty() && !names.contains(field.name))
      return "must name a measure of \"also\" in braces, got " + in_quotes(field.name);
    if (!field.form.empty() && field.form != "count" && !count_of(field.form) &&
        written_as(field.form).unit.empty())
      return "must have %, percent, degrees, count or of N behind the bar, got " + in_quotes(field.form);
  }
  if (parts.rest.find('{') != std::string_view::npos) return "has a { without }";
  if (parts.fields.empty() && fields == Fields::needed)
    return "must show what is measured, {}, got none in " + in_quotes(words);
  return std::nullopt;
}

std::string in_words(std::string_view words, const NamedSpreads& spreads) {
  const Template parts = template_of(words);
  std::string text;
  for (const Field& field : parts.fields) {
    const auto spread = spreads.find(field.name);
    if (spread == spreads.end()) throw std::invalid_argument("words: nothing is measured as " + field.name);
    text.append(field.before).append(field_text(field.form, spread->second));
  }
  return text.append(parts.rest);
}

std::string allowed_in_words(std::string_view words, const Allowed& allowed) {
  const std::vector<Field> fields = template_of(words).fields;
  const auto own = std::ranges::find(fields, "", &Field::name);
  const std::string form = own == fields.end() ? "" : own->form;
  const auto& [least, most] = allowed.printed;
  const bool is_one = least && most && *least == *most;
  if (is_one && count_of(form) && allowed.above == 0) return field_text(form, {*least, *least, *least});
  Written how = written_as(form);
  how.digits = 4;
  if (count_of(form)) how = {100, 4, " %"};
  const auto text = [&](double value) { return rounded_text(how.factor * value + 0.0, how.digits); };
  if (is_one) return text(*least) + (allowed.above > 0 ? " +- " + text(allowed.above) : "") + how.unit;
  if (least && most) return text(*least - allowed.below) + " to " + text(*most + allowed.above) + how.unit;
  return (least ? ">= " + text(*least - allowed.below) : "<= " + text(*most + allowed.above)) + how.unit;
}

}  // namespace impact_damper
