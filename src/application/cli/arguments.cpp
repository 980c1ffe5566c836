#include "arguments.hpp"

#include <algorithm>

namespace impact_damper::cli {

std::optional<double> QuantityReader::operator()(std::string_view text) {
  const auto bare = parse_number(text);
  const std::string_view unit = unit_of(dimension, true);
  if (!scales || unit == unit_of(dimension, false)) return bare;
  if (const auto value = parse_quantity(text, dimension)) return value;
  if (bare && (may_be_bare || *bare == 0)) return bare;
  std::string with_its_unit(unit);
  std::erase(with_its_unit, ' ');
  if (!problem.empty()) return std::nullopt;
  if (bare)
    problem = filled("{} could be {} {} or {} {} = {} {}: write a unit, {}{}", text, text, unit, text,
                     unit_of(dimension, false), rounded_text(*bare * scales->of(dimension), 6), unit, text,
                     with_its_unit);
  else
    problem =
        filled("must be a finite number with a unit, {}, got {}", written_units(dimension), in_quotes(text));
  return std::nullopt;
}

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

std::optional<std::string> Arguments::required_file(const std::string& option, const std::string& what) {
  std::optional<std::string> name = file(option);
  if (!name) reject(option, "must be given: " + what);
  return name;
}

std::vector<std::string> Arguments::files(const std::string& argument) {
  std::vector<std::string> files;
  if (const auto first = file(argument)) files.push_back(*first);
  for (const std::string& more : more_) {
    if (more.starts_with('-')) throw UsageError({Problem{"", "unknown argument " + in_quotes(more)}});
    files.push_back(more);
  }
  return files;
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

template <typename Parse>
std::invoke_result_t<Parse, std::string_view> Arguments::parsed(const std::string& option, NumberRange range,
                                                                Parse parse, const char* kind) {
  const std::optional<std::string> given_text = text(option);
  if (!given_text) return std::nullopt;
  const auto value = parse(*given_text);
  if (value && range.allows(*value)) return value;
  reject(option, filled("must be {}, got {}", range.describe(kind), in_quotes(*given_text)));
  return std::nullopt;
}

QuantityReader Arguments::reader_of(const std::string& option) const {
  const auto found = dimensions_.find(option);
  if (found == dimensions_.end()) return {};
  return {.dimension = found->second, .scales = scales_, .may_be_bare = true};
}

std::optional<double> Arguments::number(const std::string& option, NumberRange range) {
  return quantity(option, reader_of(option), range);
}

std::optional<std::vector<double>> Arguments::numbers(const std::string& option) const {
  const auto list = text(option);
  QuantityReader read = reader_of(option);
  return list ? numbers_of(*list, ':', read) : std::nullopt;
}

std::optional<double> Arguments::quantity(const std::string& option, QuantityReader read, NumberRange range) {
  const std::size_t before = problems_.size();
  const auto value = parsed(option, range, std::ref(read), "a finite number");
  if (problems_.size() > before && !read.problem.empty()) problems_.back().message = read.problem;
  return value;
}

std::optional<std::int64_t> Arguments::whole_number(const std::string& option, NumberRange range) {
  return parsed(option, range, parse_integer, "a whole number");
}

std::optional<std::size_t> Arguments::word(const std::string& option,
                                           const std::vector<std::string_view>& words) {
  const std::optional<std::string> given_text = text(option);
  if (!given_text) return std::nullopt;
  const auto found = std::ranges::find(words, *given_text);
  if (found != words.end()) return std::size_t(found - words.begin());
  reject(option, filled("must be one of {}, got {}{}", joined(words, ", "), in_quotes(*given_text),
                        did_you_mean(*given_text, words)));
  return std::nullopt;
}

std::optional<std::size_t> Arguments::required_word(const std::string& option,
                                                    const std::vector<std::string_view>& words) {
  if (!given(option)) reject(option, "must be given: " + listed(words, "or"));
  return word(option, words);
}

void Arguments::reject(const std::string& option, const std::string& what) {
  problems_.push_back({option, what});
}

void Arguments::finish() const {
  if (!problems_.empty()) throw UsageError(problems_);
}

Threads threads_of(Arguments& arguments) { return arguments.whole_number("--threads", within(1, 1024)); }

std::optional<Triple> parse_triple(std::string_view text, QuantityReader& first, QuantityReader& second) {
  const auto parts = parts_of(text, ':');
  if (parts.size() != 3) return std::nullopt;
  const auto a = first(parts[0]), b = second(parts[1]);
  const auto count = parse_integer(parts[2]);
  if (!a || !b || !count) return std::nullopt;
  return Triple{*a, *b, *count};
}

std::optional<Varied> varied_of(Arguments& arguments, const std::string& text,
                                const std::vector<std::string_view>& names, const std::string& option) {
  const std::size_t equals = text.find('=');
  std::string name = text.substr(0, equals);
  std::ranges::replace(name, '-', '_');
  const auto found = std::ranges::find(names, name);
  if (found == names.end()) {
    std::string help = did_you_mean(name, names);
    constexpr std::size_t most_listed = 20;  // of a list of dampers there are up to thousands
    if (help.empty() && names.size() <= most_listed) help = "; there are " + listed(names, "and");
    arguments.reject(option, "must name a number of the scene before the =, got " + in_quotes(text) + help);
    return std::nullopt;
  }
  return Varied{static_cast<std::size_t>(found - names.begin()),
                equals == std::string::npos ? std::nullopt : std::optional(text.substr(equals + 1))};
}

}  // namespace impact_damper::cli
