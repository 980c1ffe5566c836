// Our result in the words of the paper's statement: a template of claims.json, "window from {upper} to
// {lower}", filled with measured numbers.
//
//   {}         the claim's own measure; {NAME} one of those beside it (Claim::also)
//   {NAME|%}   as a percentage: "58 % (45 to 83 %)"
//   {|of 6}    a share as a count: "all 6", "none of 6", "5 of 6"
//   {|count}   a whole number, "no" for 0
//
// Numbers have four significant digits, percentages three. A number is the ensemble's median; its extremes
// follow in brackets unless they read the same.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>

#include "impact_damper/analysis/ensemble.hpp"

namespace impact_damper {

using NamedSpreads = std::map<std::string, Spread, std::less<>>;  // "" is the claim's own measure

// "0.3344 (0.3304 to 0.3344)"; "none" where there is no number.
std::string spread_text(const Spread& spread);

// What is wrong with a template whose fields may name `names`, or absent.
std::optional<std::string> problem_of_words(std::string_view words,
                                            const std::set<std::string, std::less<>>& names);

// The template filled. It must have no problem, and `spreads` all that it names: std::invalid_argument else.
std::string in_words(std::string_view words, const NamedSpreads& spreads);

}  // namespace impact_damper
