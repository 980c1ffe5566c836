#include "impact_damper/io/json_parser.hpp"

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/text.hpp"

namespace impact_damper {
namespace {

using Json = nlohmann::json;

constexpr std::size_t deepest = 64;  // nesting; our own files need 5
constexpr std::size_t most_values = 10'000'000;
constexpr std::size_t most_parts = 100'000;  // values that are no numbers
constexpr std::size_t most_problems = 50;    // a column of a million wrong numbers need not be listed

std::string list(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text.empty() ? "none" : text;
}

// Returns line and column of the character before `position`, counted from 1.
std::string place_in(const std::string& text, std::size_t position) {
  const std::size_t end = std::min(position, text.size());
  const auto line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(end), '\n') + 1;
  const std::size_t newline = end == 0 ? std::string::npos : text.rfind('\n', end - 1);
  const std::size_t before = newline == std::string::npos ? 0 : newline + 1;
  const std::size_t column = std::max<std::size_t>(1, end - std::min(end, before));
  return "line " + std::to_string(line) + ", column " + std::to_string(column);
}

// Builds the value from the parser's events, in which a duplicate key and the depth are visible.
class Builder : public nlohmann::json_sax<Json> {
 public:
  Builder(const std::string& text, Json& root, JsonProblems& problems)
      : text_(text), root_(root), problems_(problems) {}

  bool null() override { return put(nullptr); }
  bool boolean(bool value) override { return put(value); }
  bool number_integer(std::int64_t value) override { return put(value); }
  bool number_unsigned(std::uint64_t value) override { return put(value); }
  bool number_float(double value, const std::string&) override { return put(value); }
  bool string(std::string& value) override { return count_part() && put(std::move(value)); }
  bool binary(Json::binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open(Json::object()); }
  bool end_object() override { return close(); }
  bool start_array(std::size_t) override { return open(Json::array()); }
  bool end_array() override { return close(); }

  bool key(std::string& name) override {
    if (!count_part()) return false;
    Level& level = stack_.back();
    level.key = name;
    const auto [place, added] = level.value->get_ref<Json::object_t&>().try_emplace(name);
    if (!added) problems_.add(pointer(), "duplicate key, allowed is one value for each key");
    level.next = &place->second;
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const Json::exception& error) override {
    // "[json.exception.parse_error.101] parse error at line 1, column 2: what is wrong"
    std::string what = error.what();
    what.erase(0, what.find("] ") + 2);
    if (what.starts_with("parse error at ")) what.erase(0, what.find(": ") + 2);
    problems_.add({}, place_in(text_, position) + ": " + cut(what, 200));
    return false;
  }

 private:
  struct Level {
    Json* value;
    Json* next = nullptr;  // objects: where the value of the last key goes
    std::string key;
  };

  bool too_many(const std::string& what, std::size_t allowed) {
    problems_.add({}, "too many " + what + ", allowed are " + std::to_string(allowed));
    return false;
  }
  bool count_part() {
    return ++parts_ <= most_parts || too_many("objects, arrays, keys and texts", most_parts);
  }

  template <typename Value>
  bool put(Value&& value) {
    if (++values_ > most_values) return too_many("values", most_values);
    place() = std::forward<Value>(value);
    return true;
  }

  Json& place() {
    if (stack_.empty()) return root_;
    Level& level = stack_.back();
    return level.value->is_array() ? level.value->emplace_back() : *level.next;
  }

  bool open(Json empty) {
    if (stack_.size() == deepest) {
      problems_.add({}, "nested too deeply, allowed are " + std::to_string(deepest) + " levels");
      return false;
    }
    if (!count_part()) return false;
    Json& value = place();
    value = std::move(empty);
    stack_.push_back({&value, nullptr, {}});
    return true;
  }

  bool close() {
    stack_.pop_back();
    return true;
  }

  std::string pointer() const {
    std::string text;
    for (const Level& level : stack_) {
      text +=
          '/' + (level.value->is_array() ? std::to_string(level.value->size() - 1) : json_token(level.key));
    }
    return text;
  }

  const std::string& text_;
  Json& root_;
  JsonProblems& problems_;
  std::vector<Level> stack_;
  std::size_t values_ = 0, parts_ = 0;
};

}  // namespace

std::string json_token(std::string_view key) {
  std::string token;
  for (const char c : key) token += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return cut(token);
}

JsonProblems::JsonProblems(const std::string& file) : file_(cut(file, 1000)) {}

void JsonProblems::add(const std::string& pointer, std::string_view what) {
  if (++count_ > most_problems) return;
  problems_.push_back({pointer, std::string(what)});
}

std::size_t JsonProblems::open(const std::string& pointer, const Json& object) {
  const auto [place, added] = index_.try_emplace(&object, opened_.size());
  if (added) opened_.push_back({pointer, &object});
  return place->second;
}

void JsonProblems::throw_if_any() const {
  if (count_ == 0) return;
  std::vector<Problem> problems = problems_;
  if (count_ > most_problems)
    problems.push_back({"", "and " + std::to_string(count_ - most_problems) + " more problems"});
  throw InputError(file_, problems);
}

void JsonProblems::throw_if_any_or_unknown() const {
  JsonProblems all = *this;
  for (const Opened& opened : opened_) {
    const std::vector<std::string_view> known(opened.known.begin(), opened.known.end()),
        suggested(opened.suggested.begin(), opened.suggested.end());
    for (const auto& item : opened.object->items()) {
      if (opened.known.contains(item.key())) continue;
      auto meant = nearest(item.key(), known);
      if (!meant) meant = nearest(item.key(), suggested);
      all.add(opened.pointer + '/' + json_token(item.key()),
              meant ? "unknown key, did you mean \"" + std::string(*meant) + "\"?"
                    : "unknown key, allowed are: " + list(known));
    }
  }
  all.throw_if_any();
}

bool parse_json(const std::string& text, Json& root, JsonProblems& problems) {
  // The parser takes NUL for the end of the text, whatever follows it.
  if (const std::size_t nul = text.find('\0'); nul != std::string::npos) {
    problems.add({}, place_in(text, nul + 1) + ": a NUL, allowed in no JSON text");
    return false;
  }
  // The parser's message for an empty text depends on its version.
  if (text.find_first_not_of(" \t\r\n") == std::string::npos) {
    problems.add({}, "is empty, must be JSON");
    return false;
  }
  Builder builder(text, root, problems);
  return Json::sax_parse(text, &builder);
}

}  // namespace impact_damper
