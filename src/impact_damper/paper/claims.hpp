// What the paper reports, claim by claim, and the verdict on each. Kept in data/claims.json:
//
//   {"schema": "impact-damper/claims/1",
//    "claims": [{"id": "product-mid-range", "section": "3, Effects of viscous damping",
//                "statement": "...",            what is claimed, in our words
//                "printed": "0.339",            as the paper prints it
//                "value": 0.339,                or "range": [0.05, 0.1], either end null for none
//                "tolerance": 0.008, "reason": "where the tolerance comes from",
//                "measure": {"name": "product_mid_range", "scenes": ["nu2-e06"], "from": 0.1, "to": 6},
//                "verdict": "reproduced"}]}
//
// Where another engine's runs are known to give another verdict than the exact engine's, the claim says so
// and why: "with_engine": {"cem": {"verdict": "not reproduced", "explanation": "..."}}. "cem" is the method
// that finds contact at whole steps, with its default step; locating touch and release it has no exceptions.
//
// A claim recorded as "not reproduced" or "corrected" has an "explanation" and "evidence", and a corrected
// one the "corrected" interval [least, most] that takes the place of what is printed.
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/files/json_reader.hpp"

namespace impact_damper {

struct Interval {  // both ends included; absent: none
  std::optional<double> least, most;
};

enum class Verdict { reproduced, not_reproduced, corrected };
std::string_view name_of(Verdict verdict);  // "reproduced", "not reproduced", "corrected"

// How our value is found: a name out of measures.hpp, the scenes it looks at and its numbers.
struct MeasureCall {
  std::string name;
  std::vector<std::string> scenes;
  std::map<std::string, double> numbers;
};

struct Claim {
  std::string id, section, statement, printed;
  Interval admitted;     // [value, value] or the range, before the tolerance
  double tolerance = 0;  // >= 0, in the units of the value
  std::string reason;
  MeasureCall measure;
  std::optional<Interval> corrected;
  Verdict recorded = Verdict::reproduced;
  std::string explanation, evidence;
  struct Otherwise {
    Verdict recorded = Verdict::reproduced;
    std::string explanation;
  };
  std::map<std::string, Otherwise, std::less<>> with_engine;  // by the engine's name
};

// The verdict recorded for runs of that engine.
Verdict recorded_for(const Claim& claim, std::string_view engine);

// Throws IoError if the file cannot be read, InputError naming everything that is not admitted: unknown
// measures and measure parameters and duplicate ids among it.
inline constexpr FileKind claims_kind{"claims file", 1 << 22};
std::vector<Claim> read_claims(const std::filesystem::path& file);
std::vector<Claim> parse_claims(const std::string& name, const std::string& text);

// The verdict that `ours` gives: reproduced if it lies in the admitted interval widened by the tolerance,
// corrected if it does not but lies in the corrected one, else not reproduced. NaN never agrees.
Verdict judge(const Claim& claim, double ours);

}  // namespace impact_damper
