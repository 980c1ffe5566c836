#include "arguments.hpp"

#include "impact_damper/base/number_text.hpp"

namespace impact_damper::cli {

std::optional<std::string> Arguments::text(const std::string& option) const {
  if (!given(option)) return std::nullopt;
  return texts(option).back();
}

std::optional<std::string> Arguments::file(const std::string& option) {
  std::optional<std::string> name = text(option);
  if (!name || !name->empty()) return name;
  reject(option, "must be a file name, got \"\"");
  return std::nullopt;
}

bool Arguments::flag(const std::string& option) {
  const std::vector<std::string> values = texts(option);
  if (values.size() > 1) reject(option, "is given more than once");
  if (values.size() == 1 && values[0] != "true")
    reject(option, "takes no value, got " + in_quotes(values[0]));
  return !values.empty();
}

void Arguments::reject_overwriting(const std::string& option, const std::optional<std::string>& output,
                                   const std::vector<std::filesystem::path>& inputs) {
  if (!output) return;
  for (const std::filesystem::path& input : inputs) {
    std::error_code none;  // a file that does not exist is not the same as another
    if (!std::filesystem::is_regular_file(input, none)) continue;
    if (std::filesystem::equivalent(*output, input, none)) {
      return reject(option, "must not be one of the files that are read, which would be lost, got " +
                                in_quotes(*output));
    }
  }
}

std::optional<double> Arguments::number(const std::string& option, NumberRange range) {
  const std::optional<std::string> given_text = text(option);
  if (!given_text) return std::nullopt;
  const std::optional<double> value = parse_number(*given_text);
  if (value && range.allows(*value)) return value;
  reject(option, "must be " + range.describe("a finite number") + ", got " + in_quotes(*given_text));
  return std::nullopt;
}

std::optional<std::int64_t> Arguments::whole_number(const std::string& option, NumberRange range) {
  const std::optional<std::string> given_text = text(option);
  if (!given_text) return std::nullopt;
  const std::optional<std::int64_t> value = parse_integer(*given_text);
  if (value && range.allows(*value)) return value;
  reject(option, "must be " + range.describe("a whole number") + ", got " + in_quotes(*given_text));
  return std::nullopt;
}

std::optional<std::size_t> Arguments::word(const std::string& option,
                                           const std::vector<std::string_view>& words) {
  const std::optional<std::string> given_text = text(option);
  if (!given_text) return std::nullopt;
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (*given_text == words[i]) return i;
    list += (i == 0 ? "" : ", ") + std::string(words[i]);
  }
  reject(option, "must be one of " + list + ", got " + in_quotes(*given_text));
  return std::nullopt;
}

void Arguments::reject(const std::string& option, const std::string& what) {
  problems_.push_back({option, what});
}

void Arguments::finish() const {
  if (!problems_.empty()) throw UsageError(problems_);
}

Threads threads_of(Arguments& arguments) { return arguments.whole_number("--threads", within(1, 1024)); }

std::optional<Triple> parse_triple(std::string_view text) {
  const std::size_t first = text.find(':');
  const std::size_t second = first == std::string_view::npos ? first : text.find(':', first + 1);
  if (second == std::string_view::npos) return std::nullopt;
  const auto a = parse_number(text.substr(0, first));
  const auto b = parse_number(text.substr(first + 1, second - first - 1));
  const auto count = parse_integer(text.substr(second + 1));
  if (!a || !b || !count) return std::nullopt;
  return Triple{*a, *b, *count};
}

}  // namespace impact_damper::cli
