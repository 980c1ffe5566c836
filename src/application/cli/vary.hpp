// NAME=VALUES, the text of every option that gives a number of a scene several values: --vary, --tolerance.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "arguments.hpp"

namespace impact_damper::cli {

struct Varied {
  std::size_t index = 0;              // of the name in `names`
  std::optional<std::string> values;  // the text after =; absent without one
};
// Reads the text. Absent, and noted, unless `text` names one of `names` ('-' counts as '_').
std::optional<Varied> varied_of(Arguments& arguments, const std::string& text,
                                const std::vector<std::string_view>& names,
                                const std::string& option = "--vary");

}  // namespace impact_damper::cli
