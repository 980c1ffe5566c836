// A strict reader for the project's JSON files: the problems of a file are found in one reading and named by
// their JSON pointers, the first 50 of them, then how many more there are. Unknown keys are problems, too. An
// optional key that is missing is none: its target keeps its value.
//
//   JsonDocument document = JsonDocument::read("data/claims.json", claims_kind);
//   for (ObjectReader claim : document.root().required_objects("claims", 10000)) {
//     claim.required("id", id);                          // std::string
//     claim.required("tolerance", tolerance, above(0));  // double, in a range
//     claim.optional("window", window, within(2, 99));   // keeps its default when the key is missing
//     claim.required("verdict", verdict, {Verdict::reproduced, Verdict::corrected});  // by name_of
//   }
//   document.finish();  // throws InputError with what was wrong, unknown keys included
//
// A file, text or array that is too long is rejected before it takes memory: the file by its kind, a text and
// an array by the rule they are read with, all of a file together by the parser.
//
// A field that cannot be read leaves its target as it was, so reading can go on to the next problem:
// do not act on what was read before finish() has returned.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {

// Returns the whole content of a file. Throws IoError if `file` cannot be read (a directory cannot), and
// InputError if it is longer than its kind allows: before reading if its size is known, else once that length
// is read.
std::string read_text(const std::filesystem::path& file);
std::string read_text(const std::filesystem::path& file, const FileKind& kind);

// A rule for texts: all are of one line, without control characters. Lengths are in characters.
struct TextRule {
  std::size_t least = 0, most = 4000;
  bool is_name = false;  // ASCII letters, digits, '-', '_' and '.', the first of them a letter or digit

  bool allows(std::string_view text) const;
  std::string describe() const;
};
inline constexpr TextRule some_text{1};
inline constexpr TextRule a_name{1, 64, true};  // of a scene, a claim, a file

// The rule by which a value, or each element of an array, is read; flags need none.
template <class Value>
using RuleFor = std::conditional_t<std::is_same_v<Value, std::string>, TextRule, NumberRange>;

class JsonProblems;  // what a document collects while it is read

// One object of a document; a handle, valid as long as the document. Asking for a key makes it known:
// JsonDocument::finish() reports the other keys. An object that was itself missing or of the wrong type reads
// as empty and reports nothing further.
class ObjectReader {
 public:
  // Reads the field `key` into `target`, which keeps its default if the key is missing: a double, an optional
  // one, for which null means absent, a std::int64_t, which is a JSON integer, neither 3.0 nor 3e0, a bool, a
  // std::string, or an array of one of these, except flags, each of which obeys the rule. False if there is a
  // value and it is not valid.
  template <class Target>
  requires(!Enumeration<Target>) bool optional(std::string_view key, Target& target,
                                               RuleFor<Target> rule = {});
  template <class Element>
  bool optional(std::string_view key, std::vector<Element>& target, RuleFor<Element> rule = {});
  // Reads at most `most` texts, no two of them equal.
  bool optional(std::string_view key, std::vector<std::string>& target, TextRule rule, std::size_t most);

  // Reads the field likewise, a missing key being a problem (and false).
  template <typename Target, typename... Range>
  bool required(std::string_view key, Target& target, Range... range) {
    return require(key) && optional(key, target, range...);
  }

  // Reads at most `most` arrays of two numbers each.
  bool optional(std::string_view key, std::vector<std::array<double, 2>>& target, std::size_t most);
  // Whether there is an array, a text; they leave the key unknown.
  bool is_array(std::string_view key) const;
  bool is_text(std::string_view key) const;

  // Reads one of the words name_of(value) gives for the `allowed` values.
  template <Enumeration Enum>
  bool optional(std::string_view key, Enum& target, std::initializer_list<Enum> allowed = all_of<Enum>) {
    const std::optional<std::size_t> index = word(key, words_of(allowed));
    if (index) target = allowed.begin()[*index];
    return index || !has(key);
  }
  template <typename Enum>
  bool required(std::string_view key, Enum& target, std::initializer_list<Enum> allowed) {
    return require(key) && optional(key, target, allowed);
  }
  // Returns the index in `words` of the word given; absent if missing or wrong.
  std::optional<std::size_t> word(std::string_view key, const std::vector<std::string_view>& words);
  // Reads such an index for each element of an array. False if it is no array of such words. If the key is
  // missing `target` becomes empty, and the result is true.
  bool words(std::string_view key, const std::vector<std::string_view>& words,
             std::vector<std::size_t>& target);

  // Return objects within this one. An optional one that is missing (or null) is absent.
  ObjectReader required_object(std::string_view key);
  std::optional<ObjectReader> optional_object(std::string_view key);
  // Return the elements of an array of `least` to `most` objects.
  std::vector<ObjectReader> required_objects(std::string_view key, std::size_t most, std::size_t least = 0) {
    return require(key) ? optional_objects(key, most, least) : std::vector<ObjectReader>{};
  }
  std::vector<ObjectReader> optional_objects(std::string_view key, std::size_t most, std::size_t least = 0);
  bool is_object() const { return object_ != nullptr; }  // false: the problem has been reported

  // Returns every key that is there, sorted, and makes them known: for objects whose keys are data.
  std::vector<std::string> keys();
  bool has(std::string_view key);          // makes it known
  bool holds(std::string_view key) const;  // the same, but leaves it unknown: for the kind of an object

  // Suggests a key that unknown keys may mean, without making it known: an object of a related kind has it.
  void suggest(std::string_view key);

  // Reports `what` about the field `key` (or, with "", about the object itself), in words that say what
  // is allowed and what was given. For checks that the reader cannot do.
  void reject(std::string_view key, std::string_view what);
  void reject(std::string_view key, std::size_t element, std::string_view what);  // of the array `key`
  void reject(const Problem& problem);  // its field may lie deeper: "dampers[2].clearance"
  // Whether no problem of the whole document has been reported yet, so that values may be checked together.
  bool all_valid() const;
  // Reports the field as missing unless it is there. True if it is there.
  bool require(std::string_view key);
  const std::string& pointer() const { return pointer_; }

 private:
  friend class JsonDocument;
  ObjectReader(JsonProblems* problems, std::string pointer, const nlohmann::json* object);
  const nlohmann::json* find(std::string_view key);
  std::string pointer_to(std::string_view key) const;
  bool wrong(std::string_view key, const std::string& wanted, const nlohmann::json& given);
  bool too_long(std::string_view key, std::size_t most, const nlohmann::json& array);

  JsonProblems* problems_;
  std::string pointer_;
  const nlohmann::json* object_;  // null: missing or of the wrong type, already reported
  std::size_t opened_ = 0;        // index of this object's known keys in problems_
};

class JsonDocument {
 public:
  // Reads and parses `file`. Throws IoError if it cannot be read, InputError if reading cannot continue: a
  // file longer than its kind allows, what is not JSON (with line and column), text after the value, too much
  // of it. A duplicate key is a problem among the others.
  static JsonDocument read(const std::filesystem::path& file, const FileKind& kind);
  // Parses a text in memory, likewise; `name` stands for the file in messages.
  static JsonDocument parse(const std::string& name, const std::string& text);

  ObjectReader root();  // reported unless it is an object
  // Throws InputError if anything was wrong; unknown keys come last, each with the nearest known name.
  void finish() const;

  JsonDocument(JsonDocument&&) noexcept;
  JsonDocument& operator=(JsonDocument&&) noexcept;
  ~JsonDocument();

 private:
  JsonDocument();
  std::unique_ptr<nlohmann::json> value_;
  std::unique_ptr<JsonProblems> problems_;
};

}  // namespace impact_damper
