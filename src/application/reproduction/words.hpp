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
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "application/reproduction/claims.hpp"
#include "impact_damper/analysis/ensemble.hpp"

namespace impact_damper {

using NamedSpreads = std::map<std::string, Spread, std::less<>>;  // "" is the claim's own measure

// Returns the problem of a template whose fields may name `names`, absent if there is none. With
// Fields::needed it must have a field.
enum class Fields { allowed, needed };
std::optional<std::string> problem_of_words(std::string_view words,
                                            const std::set<std::string, std::less<>>& names, Fields fields);

// Returns the filled template. It must have no problem, and `spreads` all that it names; throws
// std::invalid_argument otherwise.
std::string in_words(std::string_view words, const NamedSpreads& spreads);

// Returns what lies between `least` and `most` or, where they are equal, within the tolerance of it, in the
// unit of the first field "{}" of the template, which must have no problem: "4 to 15 %", ">= 5 degrees", "all
// 6", "5 +- 0.1".
std::string allowed_in_words(std::string_view words, const Allowed& allowed);

}  // namespace impact_damper
