#include "impact_damper/paper/claims.hpp"

#include <set>

#include "impact_damper/engine.hpp"
#include "impact_damper/files/json_reader.hpp"
#include "impact_damper/paper/measures.hpp"

namespace impact_damper {
namespace {

constexpr std::string_view schema = "impact-damper/claims/1";

void require_text(ObjectReader& object, std::string_view key, std::string& target) {
  if (object.required(key, target) && target.empty()) object.refuse(key, "must not be empty");
}

Interval read_interval(ObjectReader& object, std::string_view key) {
  std::vector<std::optional<double>> ends;
  if (!object.optional(key, ends)) return {};
  if (ends.size() != 2 || (!ends[0] && !ends[1]) || (ends[0] && ends[1] && !(*ends[0] <= *ends[1]))) {
    object.refuse(key, "must be [least, most], at least one of them a number, least <= most");
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
  if (measure.most_scenes > 0) {
    object.required("scenes", call.scenes);
    const std::size_t count = call.scenes.size();
    if (count < measure.least_scenes || count > measure.most_scenes)
      object.refuse("scenes", "must name " + std::to_string(measure.least_scenes) + " to " +
                                  std::to_string(measure.most_scenes) + " scenes, got " +
                                  std::to_string(count));
  }
  for (const std::string_view number : measure.numbers) {
    double value = 0;
    if (object.required(number, value)) call.numbers[std::string(number)] = value;
  }
  return call;
}

constexpr auto verdicts = {Verdict::reproduced, Verdict::not_reproduced, Verdict::corrected};

Claim read_claim(ObjectReader& object) {
  Claim claim;
  require_text(object, "id", claim.id);
  require_text(object, "section", claim.section);
  require_text(object, "statement", claim.statement);
  require_text(object, "printed", claim.printed);
  if (object.has("value") == object.has("range"))
    object.refuse("value", "either value or range must be given");
  if (object.has("value")) {
    double value = 0;
    object.optional("value", value);
    claim.admitted = {value, value};
  } else {
    claim.admitted = read_interval(object, "range");
  }
  object.required("tolerance", claim.tolerance, at_least(0));
  require_text(object, "reason", claim.reason);
  claim.measure = read_measure(object.required_object("measure"));
  if (object.has("corrected")) claim.corrected = read_interval(object, "corrected");
  object.required("verdict", claim.recorded, verdicts);
  if (auto engines = object.optional_object("with_engine")) {
    for (const std::string_view engine : {Exact::name, Restitution::name, Cem::name}) {
      auto otherwise = engines->optional_object(engine);
      if (!otherwise) continue;
      Claim::Otherwise& read = claim.with_engine[std::string(engine)];
      otherwise->required("verdict", read.recorded, verdicts);
      require_text(*otherwise, "explanation", read.explanation);
    }
  }
  if (claim.recorded != Verdict::reproduced) {
    require_text(object, "explanation", claim.explanation);
    require_text(object, "evidence", claim.evidence);
  }
  if ((claim.recorded == Verdict::corrected) != claim.corrected.has_value())
    object.refuse("corrected", "must be given if and only if the verdict is \"corrected\"");
  return claim;
}

std::vector<Claim> read_document(JsonDocument document) {
  ObjectReader root = document.root();
  root.word("schema", {schema});
  root.require("schema");
  std::vector<Claim> claims;
  std::set<std::string> ids;
  for (ObjectReader object : root.required_objects("claims")) {
    claims.push_back(read_claim(object));
    if (!ids.insert(claims.back().id).second)
      object.refuse("id", "must be given once, got " + claims.back().id);
  }
  document.finish();
  return claims;
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
  }
  return {};
}

std::vector<Claim> read_claims(const std::filesystem::path& file) {
  return read_document(JsonDocument::read(file));
}
std::vector<Claim> parse_claims(const std::string& name, const std::string& text) {
  return read_document(JsonDocument::parse(name, text));
}

Verdict recorded_for(const Claim& claim, std::string_view engine) {
  const auto otherwise = claim.with_engine.find(engine);
  return otherwise == claim.with_engine.end() ? claim.recorded : otherwise->second.recorded;
}

Verdict judge(const Claim& claim, double ours) {
  const auto lies_in = [&](const Interval& interval, double margin) {
    if (!(ours == ours)) return false;
    return !(interval.least && !(ours >= *interval.least - margin)) &&
           !(interval.most && !(ours <= *interval.most + margin));
  };
  if (lies_in(claim.admitted, claim.tolerance)) return Verdict::reproduced;
  if (claim.corrected && lies_in(*claim.corrected, 0)) return Verdict::corrected;
  return Verdict::not_reproduced;
}

}  // namespace impact_damper
