#include "vary.hpp"

#include <algorithm>

#include "impact_damper/base/text.hpp"

namespace impact_damper::cli {

std::optional<Varied> varied_of(Arguments& arguments, const std::string& text,
                                const std::vector<std::string_view>& names, const std::string& option) {
  const std::size_t equals = text.find('=');
  std::string name = text.substr(0, equals);
  std::ranges::replace(name, '-', '_');
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    const auto meant = nearest(name, names);
    constexpr std::size_t most_listed = 20;  // of a list of dampers there are up to thousands
    std::string help;
    if (meant) {
      help = ", did you mean " + std::string(*meant) + "?";
    } else if (names.size() <= most_listed) {
      help = "; there are " + listed(names, "and");
    }
    arguments.reject(option, "must name a number of the scene before the =, got " + in_quotes(text) + help);
    return std::nullopt;
  }
  return Varied{static_cast<std::size_t>(found - names.begin()),
                equals == std::string::npos ? std::nullopt : std::optional(text.substr(equals + 1))};
}

}  // namespace impact_damper::cli
