// The first half of the strict reader (json_reader.hpp): parses a text into its value, and collects the
// problems found then and later. No other file needs this header.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "impact_damper/base/errors.hpp"

namespace impact_damper {

// Collects, while a document is read, its problems and the known keys of its objects.
class JsonProblems {
 public:
  explicit JsonProblems(const std::string& file);

  void add(const std::string& pointer, std::string_view what);
  bool empty() const { return count_ == 0; }

  // Returns the index of the known keys of `object`.
  std::size_t open(const std::string& pointer, const nlohmann::json& object);
  void know(std::size_t opened, std::string_view key) { opened_[opened].known.emplace(key); }
  void suggest(std::size_t opened, std::string_view key) { opened_[opened].suggested.emplace(key); }

  // Throw InputError.
  void throw_if_any() const;
  void throw_if_any_or_unknown() const;

 private:
  struct Opened {
    std::string pointer;
    const nlohmann::json* object;
    std::set<std::string, std::less<>> known{}, suggested{};
  };

  std::string file_;
  std::vector<Problem> problems_;
  std::size_t count_ = 0;
  std::vector<Opened> opened_;
  std::map<const nlohmann::json*, std::size_t> index_;
};

// Returns a key as a part of a JSON pointer.
std::string json_token(std::string_view key);

// Parses `text` into `root`. Duplicate keys, of which the last one counts, are added to `problems`. So is
// what ends the reading, after which `root` holds a part only and false is returned: what is not JSON,
// nesting deeper than 64, more than ten million values or a hundred thousand objects, arrays, keys and texts,
// which take far more memory than they are long.
bool parse_json(const std::string& text, nlohmann::json& root, JsonProblems& problems);

}  // namespace impact_damper
