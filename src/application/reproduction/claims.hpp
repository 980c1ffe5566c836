// What the paper reports, claim by claim, and the verdict on each claim. Kept in data/claims.json:
//
//   {"schema": "impact-damper/claims/1",
//    "claims": [{"id": "failure-04", "section": "3, Effects of the coefficient of restitution",
//                "statement": "...",            what is claimed, in our words
//                "printed": "approximately 0.15",  as the paper prints it
//                "kind": "approximate", "digits": ["0.15"],  how it is judged: PrintedKind
//                "measure": {"name": "first_missed", "scenes": ["nu2-e04"]},
//                "words": "first missed at {}", "also": {},  our result in the statement's terms: in_words()
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
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/analysis/ensemble.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/io/json_reader.hpp"

namespace impact_damper {

// The interval that a result must lie in, from what the paper prints: one rule for all claims. It depends on
// the printed digits or word alone, never on the result found here.
//
//   a number              half a unit of its last digit to either side: what rounding leaves open
//   "approximately" it    a whole unit to either side, and so of "about" and "nearly" it
//   a range               the same at each end
//   a bound               half a unit on the side of the bound; open on the other
//   a count               no tolerance
//   a word                the same interval wherever the word, or one that says the same, is used
//
// No number allows more than a tenth of itself, so that what is printed with one digit is not held more
// loosely than what is printed with two. A tenth is also what "proportional", "nearly one curve" and "small"
// allow.
//
// The last digit of a whole number is the last that is not zero: "31" is of two digits, "10" of one.
struct Interval {  // both ends included; absent: none
  std::optional<double> least, most;
};

struct PrintedKind {
  std::string_view name;
  std::size_t digits;       // how many printed numbers it takes
  Interval interval;        // of a word; empty for numbers
  std::string_view reason;  // why the interval is what it is
  double units = 0;         // tolerated of the last digit, at most a tenth of the number
};
const std::vector<PrintedKind>& printed_kinds();

// Returns the unit of the last digit of a number as printed, "0.339" -> 0.001, "31" -> 1, "10" -> 10. Absent
// if the text is not digits with at most one point among them, or all of them are zero.
std::optional<double> last_digit(std::string_view digits);

// The interval that a printed value allows: the value (or both ends of the range) before the tolerance, the
// tolerance at each end, and its reason.
struct Allowed {
  Interval printed;
  double below = 0, above = 0;  // tolerances, >= 0
  std::string reason;
};
// Returns it for `digits`: as many as the kind takes, each with a last_digit(), a range ascending. Throws
// std::invalid_argument otherwise.
Allowed allowed_by(const PrintedKind& kind, const std::vector<std::string>& digits);

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

struct Statement {
  std::string id, section, statement, printed;
};

struct Claim : Statement {
  Source source = Source::paper;
  Allowed allowed;
  MeasureCall measure;
  std::map<std::string, MeasureCall, std::less<>> also;  // further numbers that the templates show
  std::string words = "{}";                              // our result, a template of in_words()
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
struct OpenStatement : Statement {
  std::string explanation;
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
ClaimsFile read_claims(const std::filesystem::path& file);
ClaimsFile parse_claims(const std::string& name, const std::string& text);

// Returns the verdict for `ours`, the median of an ensemble. In the allowed interval widened by the tolerance
// it is reproduced, or derived for a claim recorded as that; otherwise corrected if `ours` lies in the
// corrected interval, else not reproduced. A claim of ours holds or does not hold instead. NaN never agrees.
Verdict judge(const Claim& claim, double ours);

// Our result in the words of the paper's statement: a template of claims.json, "window from {upper} to
// {lower}", filled with measured numbers.
//
//   {}         the claim's own measure; {NAME} one of those beside it (Claim::also)
//   {NAME|%}   a share as a percentage: "58 % (45 to 83 %)"
//   {|percent} what is measured in percent, {|degrees} in degrees: "4.04 % (3.4 to 4.7 %)"
//   {|of 6}    a share as a count: "all 6", "none of 6", "5 of 6"
//   {|count}   a whole number, "no" for 0
//
// Numbers have four significant digits, shares as percentages three. A number is the ensemble's median; its
// extremes follow in brackets unless they read the same. What is allowed is written in the unit of the
// claim's own field.
using NamedSpreads = std::map<std::string, Spread, std::less<>>;  // "" is the claim's own measure

// Returns the problem of a template whose fields may name `names`, absent if there is none. With
// Fields::needed it must have a field.
enum class Fields { allowed, needed };
std::optional<std::string> problem_of_words(std::string_view words,
                                            const std::set<std::string, std::less<>>& names, Fields fields);

// Returns the filled template, which must have no problem. Throws std::invalid_argument if a name of its
// fields is not in `spreads`.
std::string in_words(std::string_view words, const NamedSpreads& spreads);

// Returns what lies between `least` and `most` or, where they are equal, within the tolerance of it, in the
// unit of the first field "{}" of the template, which must have no problem: "4 to 15 %", ">= 5 degrees", "all
// 6", "5 +- 0.1".
std::string allowed_in_words(std::string_view words, const Allowed& allowed);

}  // namespace impact_damper
