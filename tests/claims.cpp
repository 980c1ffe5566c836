#include "application/reproduction/claims.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <regex>
#include <set>
#include <stdexcept>
#include <string>
#include <vector>

#include "application/reproduction/measures.hpp"
#include "impact_damper/base/errors.hpp"
#include "rejection.hpp"

using namespace impact_damper;

namespace {

// One claim as a file, with `from` replaced by `to`.
std::string claims_text(const std::string& from = "", const std::string& to = "") {
  std::string text = R"({"schema": "impact-damper/claims/1", "claims": [
    {"id": "a", "section": "1", "statement": "s", "printed": "2 pi", "value": 6.28, "tolerance": 0.01,
     "reason": "r", "measure": {"name": "step_limit"}, "corrected": [1.9, 2.1], "verdict": "corrected",
     "explanation": "x", "evidence": "y"}]})";
  if (const std::size_t at = text.find(from); !from.empty() && at != std::string::npos)
    text.replace(at, from.size(), to);
  return text;
}

std::string complaint(const std::string& from, const std::string& to) {
  return rejection_of<InputError>([&] { parse_claims("f", claims_text(from, to)); });
}

Claim claim_of(Interval allowed, double tolerance, std::optional<Interval> corrected = std::nullopt) {
  Claim claim;
  claim.allowed = {.printed = allowed, .below = tolerance, .above = tolerance, .reason = "r"};
  claim.corrected = corrected;
  return claim;
}

}  // namespace

TEST_CASE("a claim is read as it is written") {
  const std::vector<Claim> claims = parse_claims("f", claims_text()).claims;
  REQUIRE(claims.size() == 1);
  CHECK(claims[0].id == "a");
  CHECK(claims[0].allowed.printed.least == 6.28);
  CHECK(claims[0].allowed.printed.most == 6.28);
  CHECK(claims[0].measure.name == "step_limit");
  CHECK(claims[0].corrected->most == 2.1);
  CHECK(claims[0].recorded == Verdict::corrected);
}

TEST_CASE("a statement that is open is read beside the claims and is none of them") {
  const std::string open =
      R"(], "open": [{"id": "b", "section": "5", "statement": "s", "printed": "p", "explanation": "x"}]})";
  const ClaimsFile file = parse_claims("f", claims_text("]}", open));
  CHECK(file.claims.size() == 1);
  REQUIRE(file.open.size() == 1);
  CHECK(file.open[0].id == "b");
  CHECK(file.open[0].section == "5");
  CHECK(file.open[0].statement == "s");
  CHECK(file.open[0].printed == "p");
  CHECK(file.open[0].explanation == "x");
  CHECK(parse_claims("f", claims_text()).open.empty());
  const std::string twice =
      R"(], "open": [{"id": "a", "section": "5", "statement": "s", "printed": "p", "explanation": "x"}]})";
  CHECK(contains(complaint("]}", twice), "f: /open/0/id: must be given once"));
}

TEST_CASE("what is not valid in a claim is named with its place") {
  CHECK(contains(complaint("\"reason\": \"r\", ", ""), "f: /claims/0/reason"));
  CHECK(
      contains(complaint("\"r\"", "\"\""), "f: /claims/0/reason: must be a text of one line and 1 to 4000"));
  CHECK(contains(complaint("step_limit", "step_limits"), "/claims/0/measure/name"));
  CHECK(contains(complaint("\"step_limit\"", "\"step_limit\", \"e\": 1"), "/claims/0/measure"));
  CHECK(contains(complaint("\"step_limit\"", "\"zeta_error\""), "/claims/0/measure/restitution"));
  CHECK(contains(complaint("\"step_limit\"", "\"largest_loss\""), "/claims/0/measure/scenes"));
  CHECK(contains(complaint("\"value\": 6.28", "\"value\": 6.28, \"range\": [1, 2]"),
                 "/claims/0/value: one of it, \"range\" and \"kind\" must be given, got both"));
  CHECK(contains(complaint("\"value\": 6.28", "\"range\": [2, 1]"), "least <= most"));
  CHECK(contains(complaint("\"value\": 6.28", "\"range\": [null, null]"), "/claims/0/range"));
  CHECK(contains(complaint("0.01", "-0.01"), "/claims/0/tolerance"));
  CHECK(contains(complaint("\"verdict\": \"corrected\"", "\"verdict\": \"right\""), "/claims/0/verdict"));
  CHECK(contains(complaint("\"corrected\": [1.9, 2.1], ", ""),
                 "/claims/0/corrected: must be given if, and only if,"));
  CHECK(contains(complaint("\"explanation\": \"x\"", "\"explanation\": \"\""), "/claims/0/explanation"));
  CHECK(contains(complaint("claims/1", "claims/2"), "/schema"));
}

TEST_CASE("a measure's numbers have ranges of their own") {
  const auto with = [](const std::string& measure) { return complaint("\"step_limit\"", measure); };
  CHECK(contains(with(R"("zeta_error", "restitution": 1.5)"),
                 "/measure/restitution: must be a number >= 0 and <= 1, got 1.5"));
  const std::string rows =
      R"("rows_with_impacts", "scenes": ["a"], "amplitude": 1, "half_cycles": 1.5, "impacts": 1)";
  CHECK(contains(with(rows), "/measure/half_cycles: must be a whole number >= 1 and <= 1000, got 1.5"));
  CHECK(contains(with(R"("loss_slope", "scenes": ["a"], "from": 2, "to": 1)"),
                 "/measure/to: must be above \"from\", 2, got 1"));
  for (const Measure& measure : measures())
    for (const std::string_view number : measure.numbers) CHECK_NOTHROW(measure_number(number));
}

TEST_CASE("another engine may have another verdict recorded, with an explanation") {
  const std::string verdict = "\"verdict\": \"corrected\"";
  const std::string otherwise =
      verdict + R"(, "with_engine": {"cem": {"verdict": "reproduced", "explanation": "h"}})";
  const std::vector<Claim> claims = parse_claims("f", claims_text(verdict, otherwise)).claims;
  CHECK(recorded_for(claims[0], "cem") == Verdict::reproduced);
  CHECK(recorded_for(claims[0], "exact") == Verdict::corrected);
  CHECK(recorded_for(claims[0], "") == Verdict::corrected);
  CHECK(contains(complaint(verdict, verdict + R"(, "with_engine": {"cen": {}})"), "/with_engine/cen"));
  CHECK(contains(complaint(verdict, verdict + R"(, "with_engine": {"cem": {"verdict": "reproduced"}})"),
                 "/with_engine/cem/explanation"));
}

TEST_CASE("an id is given once") {
  const std::string text = claims_text();
  const std::size_t open = text.find('[') + 1, close = text.rfind(']');
  const std::string one = text.substr(open, close - open);
  CHECK_THROWS_AS(parse_claims("f", text.substr(0, close) + "," + one + text.substr(close)), InputError);
}

TEST_CASE("the verdict follows from the value alone") {
  const Claim value = claim_of({2, 2}, 0.5);
  CHECK(judge(value, 1.5) == Verdict::reproduced);
  CHECK(judge(value, 2.5) == Verdict::reproduced);
  CHECK(judge(value, 2.51) == Verdict::not_reproduced);
  CHECK(judge(value, std::nan("")) == Verdict::not_reproduced);
  const Claim bound = claim_of({6, std::nullopt}, 0);
  CHECK(judge(bound, 1e300) == Verdict::reproduced);
  CHECK(judge(bound, 5.99) == Verdict::not_reproduced);
  const Claim slip = claim_of({1, 1}, 0.1, Interval{5, 6});
  CHECK(judge(slip, 1.05) == Verdict::reproduced);
  CHECK(judge(slip, 5.5) == Verdict::corrected);
  CHECK(judge(slip, 6.05) == Verdict::not_reproduced);
  CHECK(judge(slip, std::nan("")) == Verdict::not_reproduced);
}

TEST_CASE("a derivation that agrees is derived, not reproduced") {
  Claim claim = claim_of({2, 2}, 0);
  claim.recorded = Verdict::derived;
  CHECK(judge(claim, 2) == Verdict::derived);
  CHECK(judge(claim, 3) == Verdict::not_reproduced);
  CHECK(name_of(Verdict::derived) == "derived");
}

TEST_CASE("what is ours and not the paper's holds or does not hold") {
  Claim claim = claim_of({2, 2}, 0);
  claim.source = Source::ours;
  CHECK(judge(claim, 2) == Verdict::holds);
  CHECK(judge(claim, 3) == Verdict::does_not_hold);
  claim.source = Source::quoted;
  CHECK(judge(claim, 2) == Verdict::reproduced);
  const std::string wrong =
      R"(/claims/0/verdict: must be "holds" or "does not hold" if, and only if, the source is "ours")";
  CHECK(contains(complaint("\"verdict\": \"corrected\"", R"("source": "ours", "verdict": "corrected")"),
                 wrong));
  CHECK(
      contains(complaint("\"verdict\": \"corrected\"", R"("source": "quoted", "verdict": "holds")"), wrong));
  CHECK(complaint("\"corrected\": [1.9, 2.1], \"verdict\": \"corrected\"",
                  R"("source": "ours", "verdict": "does not hold")") == not_rejected);
}

TEST_CASE("the unit of a printed number's last digit is that of the last that counts") {
  const std::pair<const char*, double> units[] = {{"0.339", 0.001}, {"5.0", 0.1}, {"31", 1}, {"10", 10},
                                                  {"0.01", 0.01},   {"120", 10},  {"4.", 1}, {"0.10", 0.01},
                                                  {".5", 0.1},      {"105", 1}};
  for (const auto& each : units) {
    CAPTURE(each.first);
    CHECK(last_digit(each.first).value_or(-1) == each.second);
  }
  for (const char* digits : {"", "-1", "1e-8", "0", "0.00", ".", "1.2.3", " 1", "2 pi"}) {
    CAPTURE(digits);
    CHECK_FALSE(last_digit(digits));
  }
}

namespace {

Allowed allowed(const std::string& name, const std::vector<std::string>& digits = {}) {
  for (const PrintedKind& kind : printed_kinds())
    if (kind.name == name) return allowed_by(kind, digits);
  throw std::logic_error("no such kind");
}

}  // namespace

TEST_CASE("what is printed decides the tolerance, by one rule") {
  const auto least = [](const Allowed& a) { return *a.printed.least - a.below; };
  const auto most = [](const Allowed& a) { return *a.printed.most + a.above; };
  CHECK(least(allowed("number", {"0.339"})) == doctest::Approx(0.3385));
  CHECK(most(allowed("number", {"0.339"})) == doctest::Approx(0.3395));
  CHECK(most(allowed("number", {"31"})) == doctest::Approx(31.5));
  CHECK(least(allowed("approximate", {"0.15"})) == doctest::Approx(0.14));
  CHECK(most(allowed("approximate", {"5.0"})) == doctest::Approx(5.1));
  // One digit is held no more loosely than two.
  CHECK(least(allowed("approximate", {"0.1"})) == doctest::Approx(0.09));
  CHECK(most(allowed("approximate", {"0.1"})) == doctest::Approx(0.11));
  CHECK(most(allowed("number", {"0.1"})) == doctest::Approx(0.11));
  CHECK(least(allowed("at_least", {"10"})) == doctest::Approx(9));
  CHECK(most(allowed("at_most", {"10"})) == doctest::Approx(11));
  CHECK(least(allowed("range", {"0.05", "0.1"})) == doctest::Approx(0.045));
  CHECK(most(allowed("range", {"0.05", "0.1"})) == doctest::Approx(0.11));
  CHECK(least(allowed("at_least", {"6.0"})) == doctest::Approx(5.95));
  CHECK_FALSE(allowed("at_least", {"6.0"}).printed.most);
  CHECK(most(allowed("at_most", {"6.0"})) == doctest::Approx(6.05));
  CHECK_FALSE(allowed("at_most", {"6.0"}).printed.least);
  CHECK(least(allowed("count", {"6"})) == 6);
  CHECK(most(allowed("count", {"6"})) == 6);
  for (const char* digits : {"0.1", "0.15", "5.0", "10", "31", "0.339"})
    for (const char* kind : {"number", "approximate"})
      CHECK(allowed(kind, {digits}).above <= std::stod(digits) * 0.1 * (1 + 1e-15));
  for (const PrintedKind& kind : printed_kinds()) {
    CAPTURE(kind.name);
    CHECK(!kind.reason.empty());
    if (kind.digits == 0) CHECK((kind.interval.least || kind.interval.most));
    CHECK_THROWS_AS(allowed_by(kind, {"1", "2", "3"}), std::invalid_argument);
  }
  CHECK_THROWS_AS(allowed("range", {"2", "1"}), std::invalid_argument);
  CHECK_THROWS_AS(allowed("number", {"2 pi"}), std::invalid_argument);
}

TEST_CASE("a kind takes the place of value, tolerance and reason in a claim") {
  const std::string stated = R"("value": 6.28, "tolerance": 0.01,
     "reason": "r",)";
  const std::vector<Claim> claims =
      parse_claims("f", claims_text(stated, R"("kind": "approximate", "digits": ["0.15"],)")).claims;
  CHECK(claims[0].allowed.printed.least == 0.15);
  CHECK(claims[0].allowed.above == doctest::Approx(0.01));
  CHECK(contains(complaint(stated, R"("kind": "approximate", "digits": ["0.15", "2"],)"),
                 "/claims/0/digits: must be 1 numbers as printed, got 2"));
  CHECK(contains(complaint(stated, R"("kind": "number", "digits": ["2 pi"],)"),
                 "/claims/0/digits: must be a number"));
  CHECK(contains(complaint(stated, R"("kind": "aproximate", "digits": ["1"],)"),
                 "/claims/0/kind: unknown, did you mean \"approximate\"?"));
  CHECK(contains(complaint(stated, R"("kind": "number", "digits": ["1"], "tolerance": 1,)"),
                 "/claims/0/tolerance: unknown key"));
}

TEST_CASE("our result is written in the words of the statement") {
  const NamedSpreads spreads{
      {"", {0.5, 0.25, 1}}, {"upper", {4.64123, 4.64121, 4.64124}}, {"none", {0, 0, 0}}};
  CHECK(in_words("{}", spreads) == "0.5 (0.25 to 1)");
  CHECK(in_words("in {|%} of them", spreads) == "in 50 % (25 to 100 %) of them");
  CHECK(in_words("three in {|of 6}", spreads) == "three in 3 of 6 (2 of 6 to all 6)");
  CHECK(in_words("from {upper} down", spreads) == "from 4.641 down");
  CHECK(in_words("{none|count} contacts, {upper|count} rows", spreads) == "no contacts, 5 rows");
  CHECK(in_words("{}", {{"", {std::nan(""), std::nan(""), std::nan("")}}}) == "none");
  CHECK(in_words("{}", {{"", {4.2, 4.1, INFINITY}}}) == "4.2 (4.1 to none)");
  CHECK(in_words("{|%}", {{"", {-0.0, -0.0, 0.0}}}) == "0 %");
  CHECK(in_words("{|percent} of it", spreads) == "0.5 % (0.25 to 1 %) of it");
  CHECK(in_words("{upper|degrees}", spreads) == "4.641 degrees");
  CHECK_THROWS_AS(in_words("{lower}", spreads), std::invalid_argument);
  const std::string verdict = "\"verdict\": \"corrected\"";
  const auto with = [&](const std::string& words) {
    return complaint(verdict, verdict + ", \"words\": " + words);
  };
  CHECK(with("\"{}\"") == not_rejected);
  CHECK(contains(with("\"three\""), "/claims/0/words: must show what is measured"));
  CHECK(contains(with("\"{\""), "/claims/0/words: has a {"));
  CHECK(contains(with("\"{a}\""), "/claims/0/words: must name a measure of \"also\""));
  CHECK(contains(with("\"{|of 0}\""), "behind the bar, got \"of 0\""));
  CHECK(with("\"{a}\", \"also\": {\"a\": {\"name\": \"step_limit\"}}") == not_rejected);
  CHECK(contains(with("\"{a}\", \"also\": {\"a\": {\"name\": \"step\"}}"), "/claims/0/also/a/name"));
  CHECK(
      contains(complaint(verdict, verdict + ", \"source\": \"theirs\""), "/claims/0/source: must be one of"));
}

TEST_CASE("what is allowed has the unit that our result has") {
  CHECK(allowed_in_words("{|percent} on average", allowed("nearly_one_curve")) == "0 to 10 %");
  CHECK(allowed_in_words("{|%} of it", allowed("small")) == "-10 to 10 %");
  CHECK(allowed_in_words("{other} and {|degrees}", allowed("unequal_angles")) == ">= 5 degrees");
  CHECK(allowed_in_words("{|percent} less", allowed("range", {"5", "10"})) == "4.5 to 11 %");
  CHECK(allowed_in_words("{|percent}", allowed("number", {"31"})) == "31 +- 0.5 %");
  CHECK(allowed_in_words("three in {|of 6}", allowed("all")) == "all 6");
  CHECK(allowed_in_words("{|of 6}", allowed("mostly")) == "50 to 100 %");
  CHECK(allowed_in_words("stuck in {|%}", allowed("all")) == "100 %");
  CHECK(allowed_in_words("{|count} windows", allowed("count", {"6"})) == "6");
  CHECK(allowed_in_words("at {}", allowed("approximate", {"5.0"})) == "5 +- 0.1");
  CHECK(allowed_in_words("{upper} to {lower}", allowed("less")) == "<= 0.99");
}

TEST_CASE("explanations and evidence are templates, which need no field") {
  const auto with = [](const std::string& explanation) {
    return complaint("\"explanation\": \"x\"", "\"explanation\": \"" + explanation + "\"");
  };
  CHECK(with("It is {|percent}.") == not_rejected);
  CHECK(contains(with("It is {other}."), "/claims/0/explanation: must name a measure of \"also\""));
  CHECK(contains(complaint("\"y\"", "\"{|kg}\""), "/claims/0/evidence: must have %, percent, degrees"));
}

namespace {

// Numbers of a text that are results: not in a field, a name, an equation's number or a formula, not a small
// whole number and not one of `known`.
std::vector<std::string> typed_numbers(std::string text, const std::string& known) {
  for (const char* allowed :
       {R"(\{[^}]*\})", R"([A-Za-z0-9_]+-[A-Za-z0-9-]+)", R"(\(M[0-9.]+\))", R"(Figure [0-9]+)",
        R"(\b(k|e|nu|zeta|x0) = [0-9.e+-]*[0-9])", R"([A-Za-z_)]\^[0-9]+)",
        R"(\b[0-9]{1,2}(?![0-9]|[.][0-9]|e[0-9]| percent| %))"})
    text = std::regex_replace(text, std::regex(allowed), " ");
  const std::regex number(R"([0-9]+([.][0-9]+)?(e[+-]?[0-9]+)?)");
  std::vector<std::string> found;
  for (std::sregex_iterator each(text.begin(), text.end(), number), end; each != end; ++each)
    if (known.find(each->str()) == std::string::npos) found.push_back(each->str());
  return found;
}

}  // namespace

TEST_CASE("the project's own claims are allowed, and no result is typed into what explains them") {
  CHECK(typed_numbers("First missed at {}, below 0.132.", "") == std::vector<std::string>{"0.132"});
  CHECK(typed_numbers("Between 1 percent slower and 4 % faster; a median of 100", "").size() == 3);
  CHECK(
      typed_numbers("In (M14.7) of Figure 13, l^2 - 2 s, e = 0.6, {closed} and figure-5-count", "").empty());
  CHECK(typed_numbers("At the printed 0.15", "approximately 0.15").empty());
  const std::vector<Claim> claims = read_claims(SOURCE_FOLDER "/data/claims.json").claims;
  CHECK(claims.size() >= 40);
  for (const Claim& claim : claims) {
    CAPTURE(claim.id);
    std::vector<std::string> texts{claim.explanation, claim.evidence};
    for (const auto& [engine, otherwise] : claim.with_engine) texts.push_back(otherwise.explanation);
    for (const std::string& text : texts)
      CHECK(typed_numbers(text, claim.printed + claim.statement) == std::vector<std::string>{});
  }
}

TEST_CASE("one measure is one claim") {
  std::set<std::string> known;
  for (const Claim& claim : read_claims(SOURCE_FOLDER "/data/claims.json").claims) {
    std::string call = claim.measure.name;
    for (const std::string& scene : claim.measure.scenes) call += " " + scene;
    for (const std::string& response : claim.measure.responses) call += " " + response;
    for (const auto& [name, value] : claim.measure.numbers) call += " " + name + std::to_string(value);
    CAPTURE(claim.id);
    CHECK(known.insert(call).second);
  }
}
