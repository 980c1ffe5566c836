#include "impact_damper/paper/claims.hpp"

#include <doctest/doctest.h>

#include <cmath>
#include <string>

#include "impact_damper/files/errors.hpp"
#include "impact_damper/paper/measure_numbers.hpp"
#include "impact_damper/paper/measures.hpp"

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
  try {
    parse_claims("f", claims_text(from, to));
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

Claim claim_of(Interval admitted, double tolerance, std::optional<Interval> corrected = std::nullopt) {
  Claim claim;
  claim.admitted = admitted;
  claim.tolerance = tolerance;
  claim.corrected = corrected;
  return claim;
}

}  // namespace

TEST_CASE("a claim is read as it is written") {
  const std::vector<Claim> claims = parse_claims("f", claims_text());
  REQUIRE(claims.size() == 1);
  CHECK(claims[0].id == "a");
  CHECK(claims[0].admitted.least == 6.28);
  CHECK(claims[0].admitted.most == 6.28);
  CHECK(claims[0].measure.name == "step_limit");
  CHECK(claims[0].corrected->most == 2.1);
  CHECK(claims[0].recorded == Verdict::corrected);
}

TEST_CASE("what is not admitted in a claim is named with its place") {
  CHECK(complaint("\"reason\": \"r\", ", "").find("f: /claims/0/reason") != std::string::npos);
  CHECK(complaint("\"r\"", "\"\"").find("f: /claims/0/reason: must be a text of one line and 1 to 4000") !=
        std::string::npos);
  CHECK(complaint("step_limit", "step_limits").find("/claims/0/measure/name") != std::string::npos);
  CHECK(complaint("\"step_limit\"", "\"step_limit\", \"e\": 1").find("/claims/0/measure") !=
        std::string::npos);
  CHECK(complaint("\"step_limit\"", "\"zeta_error\"").find("/claims/0/measure/restitution") !=
        std::string::npos);
  CHECK(complaint("\"step_limit\"", "\"largest_loss\"").find("/claims/0/measure/scenes") !=
        std::string::npos);
  CHECK(complaint("\"value\": 6.28", "\"value\": 6.28, \"range\": [1, 2]")
            .find("/claims/0/value: either it or \"range\" must be given, got both") != std::string::npos);
  CHECK(complaint("\"value\": 6.28", "\"range\": [2, 1]").find("least <= most") != std::string::npos);
  CHECK(complaint("\"value\": 6.28", "\"range\": [null, null]").find("/claims/0/range") != std::string::npos);
  CHECK(complaint("0.01", "-0.01").find("/claims/0/tolerance") != std::string::npos);
  CHECK(complaint("\"verdict\": \"corrected\"", "\"verdict\": \"right\"").find("/claims/0/verdict") !=
        std::string::npos);
  CHECK(complaint("\"corrected\": [1.9, 2.1], ", "")
            .find("/claims/0/corrected: must be given if, and only if,") != std::string::npos);
  CHECK(complaint("\"explanation\": \"x\"", "\"explanation\": \"\"").find("/claims/0/explanation") !=
        std::string::npos);
  CHECK(complaint("claims/1", "claims/2").find("/schema") != std::string::npos);
}

TEST_CASE("a measure's numbers have ranges of their own") {
  const auto with = [](const std::string& measure) { return complaint("\"step_limit\"", measure); };
  CHECK(with(R"("zeta_error", "restitution": 1.5)")
            .find("/measure/restitution: must be a number >= 0 and <= 1, got 1.5") != std::string::npos);
  const std::string rows =
      R"("rows_with_impacts", "scenes": ["a"], "amplitude": 1, "half_cycles": 1.5, "impacts": 1)";
  CHECK(with(rows).find("/measure/half_cycles: must be a whole number >= 1 and <= 1000, got 1.5") !=
        std::string::npos);
  CHECK(with(R"("loss_slope", "scenes": ["a"], "from": 2, "to": 1)")
            .find("/measure/to: must be above \"from\", 2, got 1") != std::string::npos);
  for (const Measure& measure : measures())
    for (const std::string_view number : measure.numbers) CHECK_NOTHROW(measure_number(number));
}

TEST_CASE("another engine may have another verdict recorded, with an explanation") {
  const std::string verdict = "\"verdict\": \"corrected\"";
  const std::vector<Claim> claims = parse_claims(
      "f",
      claims_text(verdict,
                  verdict + R"(, "with_engine": {"cem": {"verdict": "reproduced", "explanation": "h"}})"));
  CHECK(recorded_for(claims[0], "cem") == Verdict::reproduced);
  CHECK(recorded_for(claims[0], "exact") == Verdict::corrected);
  CHECK(recorded_for(claims[0], "") == Verdict::corrected);
  CHECK(complaint(verdict, verdict + R"(, "with_engine": {"cen": {}})").find("/with_engine/cen") !=
        std::string::npos);
  CHECK(complaint(verdict, verdict + R"(, "with_engine": {"cem": {"verdict": "reproduced"}})")
            .find("/with_engine/cem/explanation") != std::string::npos);
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

TEST_CASE("the project's own claims are admitted, and there are at least forty") {
  const std::vector<Claim> claims = read_claims(SOURCE_FOLDER "/data/claims.json");
  CHECK(claims.size() >= 40);
}
