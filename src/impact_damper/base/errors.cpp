#include "impact_damper/base/errors.hpp"

#include <utility>

namespace impact_damper {
namespace {

std::string joined(const std::vector<std::string>& lines) {
  std::string text;
  for (const std::string& line : lines) text += (text.empty() ? "" : "\n") + line;
  return text;
}

}  // namespace

std::string pointer_of(std::string_view field) {
  std::string pointer;
  for (const char c : field) {
    if (pointer.empty()) pointer = "/";
    if (c == '[' || c == '.') pointer += '/';
    if (c != '[' && c != '.' && c != ']') pointer += c;
  }
  return pointer;
}

std::vector<std::string> lines_of(const std::vector<Problem>& problems, const std::string& head) {
  std::vector<std::string> lines;
  lines.reserve(problems.size());
  for (const auto& [field, message] : problems) {
    lines.push_back(head);
    if (!field.empty()) lines.back() += field + ": ";
    lines.back() += message;
  }
  return lines;
}

InvalidArguments::InvalidArguments(std::vector<Problem> problems)
    : std::invalid_argument(joined(lines_of(problems))), problems_(std::move(problems)) {}

void require_none(const std::vector<Problem>& problems) {
  if (!problems.empty()) throw InvalidArguments(problems);
}

InputError::InputError(std::vector<std::string> problems)
    : std::runtime_error(joined(problems)), problems_(std::move(problems)) {}

InputError::InputError(const std::string& file, const std::vector<Problem>& problems)
    : InputError(lines_of(problems, file + ": ")) {}

}  // namespace impact_damper
