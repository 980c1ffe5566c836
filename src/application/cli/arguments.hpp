// The arguments of the command line, checked: every problem is found and named in one go.
//
// The parser (main.cpp) only splits text: its own conversion lets nan pass and saturates large integers.
// Values are converted here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"
#include "impact_damper/base/text.hpp"
#include "impact_damper/units.hpp"

namespace impact_damper::cli {

// Reads numbers of one dimension as the command line gives them: beside a scene in units, which has scales,
// with a unit, 12mm, else bare.
struct QuantityReader {
  Dimension dimension = Dimension::ratio;
  std::optional<Scales> scales{};
  bool may_be_bare = false;  // is in unit_of(dimension, true) then, as the option's help says
  std::string problem{};     // of the first number that lacks its unit or has that of another dimension

  // Returns the number in unit_of(dimension, scales.has_value()); absent if it is not valid.
  std::optional<double> operator()(std::string_view text);
};

// A command line that is not valid. The field of a problem is an option or an argument.
class UsageError : public InvalidArguments {
 public:
  using InvalidArguments::InvalidArguments;
};

class Arguments {
 public:
  // Each option of the command by its long name, "--output", with the texts given for it, none if it was not
  // given; a flag's is "true". `more` follow the named ones.
  Arguments(std::map<std::string, std::vector<std::string>> options, std::vector<std::string> more)
      : options_(std::move(options)), more_(std::move(more)) {}

  // Return the value. Absent if the option was not given, or is not valid: then it is noted for finish().
  std::optional<std::string> text(const std::string& option) const;
  const std::vector<std::string>& texts(const std::string& option) const { return options_.at(option); }
  std::optional<std::string> file(const std::string& option);  // its name
  std::optional<double> number(const std::string& option, NumberRange range = {});
  std::optional<double> quantity(const std::string& option, QuantityReader read, NumberRange range = {});
  std::optional<std::int64_t> whole_number(const std::string& option, NumberRange range = {});
  std::optional<std::size_t> word(const std::string& option, const std::vector<std::string_view>& words);
  // Rejects as well that it is not given.
  std::optional<std::size_t> required_word(const std::string& option,
                                           const std::vector<std::string_view>& words);
  // Returns a value of an enumeration whose words name_of(value) gives.
  template <typename Enum>
  Enum choice(const std::string& option, std::initializer_list<Enum> allowed, Enum otherwise) {
    const std::optional<std::size_t> index = word(option, words_of(allowed));
    return index ? allowed.begin()[*index] : otherwise;
  }
  // Sets `value`, a double, an optional one or a std::int64_t, if the option is given and valid.
  template <typename Value>
  void read(const std::string& option, Value& value, NumberRange range = {}) {
    if constexpr (std::is_integral_v<Value>)
      value = whole_number(option, range).value_or(value);
    else if (const auto given_value = number(option, range))
      value = *given_value;
  }
  // Lets number() and numbers() of these options read a unit, too, beside a scene in units, which has scales.
  void may_have_units(const std::optional<Scales>& scales, std::map<std::string, Dimension> dimensions) {
    scales_ = scales;
    dimensions_ = std::move(dimensions);
  }
  // Returns the numbers A:B:... of an option; absent, without a problem noted, unless all are valid.
  std::optional<std::vector<double>> numbers(const std::string& option) const;
  // Returns the file of an option, or rejects that it is not given: "must be given: WHAT".
  std::optional<std::string> required_file(const std::string& option, const std::string& what);
  // Returns the files of an argument and those after the named arguments, which are no option with many
  // values: that would take "[]" for an empty list. Throws UsageError for an unknown option among them.
  std::vector<std::string> files(const std::string& argument);
  bool offers(const std::string& option) const { return options_.contains(option); }
  bool given(const std::string& option) const { return !texts(option).empty(); }
  bool flag(const std::string& option);  // given, once and without a value
  // Rejects an output that is one of these files, which it would overwrite.
  void reject_overwriting(const std::string& option, const std::optional<std::string>& output,
                          const std::vector<std::filesystem::path>& inputs);

  // Notes a problem for finish(): "what is allowed, what was given".
  void reject(const std::string& option, const std::string& what);
  // Throws UsageError if anything was noted.
  void finish() const;

 private:
  // Returns the number that parse() finds in the text of an option. `kind`: "a number", for messages.
  template <typename Parse>
  std::invoke_result_t<Parse, std::string_view> parsed(const std::string& option, NumberRange range,
                                                       Parse parse, const char* kind);

  // Reads the numbers of an option.
  QuantityReader reader_of(const std::string& option) const;

  std::map<std::string, std::vector<std::string>> options_;
  std::optional<Scales> scales_;
  std::map<std::string, Dimension> dimensions_;
  std::vector<std::string> more_;
  std::vector<Problem> problems_;
};

// Returns --threads N, an option of every command that simulates more than one scene.
Threads threads_of(Arguments& arguments);

// Returns the words with `between` between each two; none of them is empty.
template <class Words>
std::string joined(const Words& words, std::string_view between) {
  std::string text;
  for (const auto& word : words) text.append(text.empty() ? "" : between).append(word);
  return text;
}
// Returns the text that each element has, by a member or a function.
template <class Elements, class Text>
std::vector<std::string_view> texts_of(const Elements& elements, Text text) {
  std::vector<std::string_view> texts;
  texts.reserve(std::size(elements));
  for (const auto& element : elements) texts.push_back(std::invoke(text, element));
  return texts;
}

// Reads A:B:N of options that ask for samples: two finite numbers and a count.
struct Triple {
  double first = 0, second = 0;
  std::int64_t count = 0;
};
std::optional<Triple> parse_triple(std::string_view text, QuantityReader& first, QuantityReader& second);
inline std::optional<Triple> parse_triple(std::string_view text, QuantityReader& both) {
  return parse_triple(text, both, both);
}

// NAME=VALUES, the text of every option that gives a number of a scene several values: --vary, --tolerance.
struct Varied {
  std::size_t index = 0;              // of the name in `names`
  std::optional<std::string> values;  // the text after =; absent without one
};
// Reads the text. Absent, and noted, unless `text` names one of `names` ('-' counts as '_').
std::optional<Varied> varied_of(Arguments& arguments, const std::string& text,
                                const std::vector<std::string_view>& names,
                                const std::string& option = "--vary");

}  // namespace impact_damper::cli
