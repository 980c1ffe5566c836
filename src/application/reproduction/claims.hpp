// What the paper reports, claim by claim, and the verdict on each claim. Kept in data/claims.json:
//
//   {"schema": "impact-damper/claims/1",
//    "claims": [{"id": "failure-04", "section": "3, Effects of the coefficient of restitution",
//                "statement": "...",            what is claimed, in our words
//                "printed": "approximately 0.15",  as the paper prints it
//                "kind": "approximate", "digits": ["0.15"],  how it is judged: printed.hpp
//                "measure": {"name": "first_missed", "scenes": ["nu2-e04"]},
//                "words": "first missed at {}", "also": {},  our result in the statement's terms: words.hpp
//                "verdict": "not reproduced", "explanation": "...", "evidence": "..."}]}
//
// Where the paper prints nothing that a kind covers, as with an identity that holds to rounding, "value" or
// "range" (either end null for none) with a "tolerance" and its "reason" take the place of kind and digits.
// "source" says whose claim it is if not the paper's: "quoted" marks our reading of what the paper quotes
// from an earlier study, "ours" a claim of this project. A claim of ours, which is not in the paper, "holds"
// or "does not hold".
//
// Where another engine's runs are known to give another verdict than the exact engine's, the claim says so
// and why: "with_engine": {"cem": {"verdict": "not reproduced", "explanation": "..."}}. "cem" is the method
// that finds contact at whole steps, with its default step; locating touch and release it has no exceptions.
//
// A claim recorded as "not reproduced", "does not hold" or "corrected" has an "explanation" and "evidence",
// and a corrected one the "corrected" interval [least, most] that takes the place of what is printed. One
// recorded as "derived" has an "explanation": it cannot fail, since it follows from how something is defined
// or from another claim, and confirms that derivation. Explanations and evidence are templates as "words" is,
// so that the results that they name are measured ones.
//
// Statements of the paper that nothing here measures yet are listed beside the claims and do not count as
// claims:
//
//    "open": [{"id": "several-dampers", "section": "...", "statement": "...", "printed": "...",
//              "explanation": "..."}]           why it is open
#pragma once

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "application/reproduction/printed.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/io/json_reader.hpp"

namespace impact_damper {

enum class Verdict { reproduced, not_reproduced, corrected, derived, holds, does_not_hold };
std::string_view name_of(Verdict verdict);  // "not reproduced" and so on

enum class Source { paper, quoted, ours };  // whose claim it is

// How our value is found: the name of a measure (measures.hpp), the runs that it uses and its numbers.
struct MeasureCall {
  std::string name;
  std::vector<std::string> scenes;  // and further runs of the catalogue, by their names
  std::map<std::string, double> numbers;
  std::vector<std::string> responses{};  // of the catalogue, by their names
};

struct Claim {
  std::string id, section, statement, printed;
  Source source = Source::paper;
  Allowed allowed;
  MeasureCall measure;
  std::map<std::string, MeasureCall, std::less<>> also;  // further numbers that the templates show
  std::string words = "{}";                              // our result, a template of words.hpp
  std::optional<Interval> corrected;
  Verdict recorded = Verdict::reproduced;
  std::string explanation, evidence;  // templates
  struct Otherwise {
    Verdict recorded = Verdict::reproduced;
    std::string explanation;  // a template
  };
  std::map<std::string, Otherwise, std::less<>> with_engine;  // by the engine's name
};

// A statement of the paper that has no measure yet, and so no verdict.
struct OpenStatement {
  std::string id, section, statement, printed, explanation;
};

struct ClaimsFile {
  std::vector<Claim> claims;
  std::vector<OpenStatement> open;
};

// Returns the verdict recorded for runs of that engine.
Verdict recorded_for(const Claim& claim, std::string_view engine);

// Throws IoError if the file cannot be read, InputError if it is not valid, as with unknown measures or
// measure parameters, or duplicate ids.
inline constexpr FileKind claims_kind{"claims file", 1 << 22};
ClaimsFile read_claims_file(const std::filesystem::path& file);
ClaimsFile parse_claims_file(const std::string& name, const std::string& text);
// Return the claims alone.
std::vector<Claim> read_claims(const std::filesystem::path& file);
std::vector<Claim> parse_claims(const std::string& name, const std::string& text);

// Returns the verdict for `ours`, the median of an ensemble. In the allowed interval widened by the tolerance
// it is reproduced, or derived for a claim recorded as that; otherwise corrected if `ours` lies in the
// corrected interval, else not reproduced. A claim of ours holds or does not hold instead. NaN never agrees.
Verdict judge(const Claim& claim, double ours);

}  // namespace impact_damper
