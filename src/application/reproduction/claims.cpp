#include "application/reproduction/claims.hpp"

#include <set>
#include <stdexcept>

#include "application/reproduction/measure_numbers.hpp"
#include "application/reproduction/measures.hpp"
#include "application/reproduction/words.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/engine.hpp"
#include "impact_damper/io/json_reader.hpp"

namespace impact_damper {
namespace {

constexpr std::string_view schema = "impact-damper/claims/1";

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

Claim read_claim(ObjectReader& object) {
  Claim claim;
  object.required("id", claim.id, a_name);
  object.required("section", claim.section, some_text);
  object.required("statement", claim.statement, some_text);
  object.required("printed", claim.printed, some_text);
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

OpenStatement read_open_statement(ObjectReader& object) {
  OpenStatement statement;
  object.required("id", statement.id, a_name);
  object.required("section", statement.section, some_text);
  object.required("statement", statement.statement, some_text);
  object.required("printed", statement.printed, some_text);
  object.required("explanation", statement.explanation, some_text);
  return statement;
}

ClaimsFile read_document(JsonDocument document) {
  ObjectReader root = document.root();
  root.word("schema", {schema});
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
    file.open.push_back(read_open_statement(object));
    once(object, file.open.back().id);
  }
  document.finish();
  return file;
}

}  // namespace

std::string_view name_of(Verdict verdict) {
  switch (verdict) {
    case Verdict::reproduced:
      return "reproduced";
    case Verdict::not_reproduced:
      return "not reproduced";
    case Verdict::corrected:
      return "corrected";
    case Verdict::derived:
      return "derived";
    case Verdict::holds:
      return "holds";
    case Verdict::does_not_hold:
      return "does not hold";
  }
  return {};
}

ClaimsFile read_claims_file(const std::filesystem::path& file) {
  return read_document(JsonDocument::read(file, claims_kind));
}
ClaimsFile parse_claims_file(const std::string& name, const std::string& text) {
  return read_document(JsonDocument::parse(name, text));
}
std::vector<Claim> read_claims(const std::filesystem::path& file) { return read_claims_file(file).claims; }
std::vector<Claim> parse_claims(const std::string& name, const std::string& text) {
  return parse_claims_file(name, text).claims;
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

}  // namespace impact_damper
