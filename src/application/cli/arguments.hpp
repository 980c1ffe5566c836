// The arguments of the command line, checked: every problem is found and named in one go.
//
// The parser (main.cpp) only splits text: its own conversion lets nan pass and saturates large integers.
// Values are converted here.
#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "impact_damper/analysis/parallel.hpp"
#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/io/json_reader.hpp"

namespace impact_damper::cli {

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
  std::optional<std::int64_t> whole_number(const std::string& option, NumberRange range = {});
  std::optional<std::size_t> word(const std::string& option, const std::vector<std::string_view>& words);
  // Returns a value of an enumeration whose words name_of(value) gives.
  template <typename Enum>
  Enum choice(const std::string& option, std::initializer_list<Enum> allowed, Enum otherwise) {
    const std::optional<std::size_t> index = word(option, words_of(allowed));
    return index ? allowed.begin()[*index] : otherwise;
  }
  bool offers(const std::string& option) const { return options_.contains(option); }
  bool given(const std::string& option) const { return !texts(option).empty(); }
  const std::vector<std::string>& more() const { return more_; }
  bool flag(const std::string& option);  // given, once and without a value
  // Rejects an output that is one of these files, which it would overwrite.
  void reject_overwriting(const std::string& option, const std::optional<std::string>& output,
                          const std::vector<std::filesystem::path>& inputs);

  // Notes a problem for finish(): "what is allowed, what was given".
  void reject(const std::string& option, const std::string& what);
  // Throws UsageError if anything was noted.
  void finish() const;

 private:
  std::map<std::string, std::vector<std::string>> options_;
  std::vector<std::string> more_;
  std::vector<Problem> problems_;
};

// Returns --threads N, an option of every command that simulates more than one scene.
Threads threads_of(Arguments& arguments);

// Reads the numbers A:B:N of `text`, for options that ask for samples: two finite numbers and a count.
struct Triple {
  double first = 0, second = 0;
  std::int64_t count = 0;
};
std::optional<Triple> parse_triple(std::string_view text);

}  // namespace impact_damper::cli
