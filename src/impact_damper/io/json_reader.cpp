#include "impact_damper/io/json_reader.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

using Json = nlohmann::json;

constexpr std::size_t deepest = 64;  // nesting; our own files need 5
constexpr std::size_t most_values = 10'000'000;
constexpr std::size_t most_parts = 100'000;  // values that are no numbers
constexpr std::size_t most_problems = 50;    // a column of a million wrong numbers need not be listed

std::string described(const Json& value) {
  switch (value.type()) {
    case Json::value_t::null:
      return "null";
    case Json::value_t::object:
      return "an object";
    case Json::value_t::array:
      return "an array";
    case Json::value_t::string:
      return "the string " + in_quotes(value.get_ref<const std::string&>());
    case Json::value_t::boolean:
      return value.get<bool>() ? "true" : "false";
    case Json::value_t::number_integer:
      return std::to_string(value.get<std::int64_t>());
    case Json::value_t::number_unsigned:
      return std::to_string(value.get<std::uint64_t>());
    case Json::value_t::number_float: {
      const std::string text = number_text(value.get<double>());  // 3.0 must not read like the integer 3
      return text.find_first_not_of("-0123456789") == std::string::npos ? text + ".0" : text;
    }
    case Json::value_t::binary:
    case Json::value_t::discarded:
      break;
  }
  return "nothing";
}

std::string list(const std::vector<std::string_view>& words) {
  std::string text;
  for (const std::string_view word : words) text += (text.empty() ? "" : ", ") + std::string(word);
  return text.empty() ? "none" : text;
}

// Returns a key as a part of a JSON pointer.
std::string json_token(std::string_view key) {
  std::string token;
  for (const char c : key) token += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return cut(token);
}

}  // namespace

// Collects, while a document is read, its problems and the known keys of its objects.
class JsonProblems {
 public:
  explicit JsonProblems(const std::string& file) : file_(cut(file, 1000)) {}

  void add(const std::string& pointer, std::string_view what) {
    if (++count_ > most_problems) return;
    problems_.push_back({pointer, std::string(what)});
  }
  bool empty() const { return count_ == 0; }

  // Returns the index of the known keys of `object`.
  std::size_t open(const std::string& pointer, const Json& object) {
    const auto [place, added] = index_.try_emplace(&object, opened_.size());
    if (added) opened_.push_back({pointer, &object});
    return place->second;
  }
  void know(std::size_t opened, std::string_view key) { opened_[opened].known.emplace(key); }
  void suggest(std::size_t opened, std::string_view key) { opened_[opened].suggested.emplace(key); }

  // Throw InputError.
  void throw_if_any() const {
    if (count_ == 0) return;
    std::vector<Problem> problems = problems_;
    if (count_ > most_problems)
      problems.push_back({"", "and " + std::to_string(count_ - most_problems) + " more problems"});
    throw InputError(file_, problems);
  }
  void throw_if_any_or_unknown() const {
    JsonProblems all = *this;
    for (const Opened& opened : opened_) {
      const std::vector<std::string_view> known(opened.known.begin(), opened.known.end()),
          suggested(opened.suggested.begin(), opened.suggested.end());
      for (const auto& item : opened.object->items()) {
        if (opened.known.contains(item.key())) continue;
        std::string meant = did_you_mean(item.key(), known, "\"");
        if (meant.empty()) meant = did_you_mean(item.key(), suggested, "\"");
        all.add(opened.pointer + '/' + json_token(item.key()),
                "unknown key" + (meant.empty() ? ", allowed are: " + list(known) : meant));
      }
    }
    all.throw_if_any();
  }

 private:
  struct Opened {
    std::string pointer;
    const Json* object;
    std::set<std::string, std::less<>> known{}, suggested{};
  };

  std::string file_;
  std::vector<Problem> problems_;
  std::size_t count_ = 0;
  std::vector<Opened> opened_;
  std::map<const Json*, std::size_t> index_;
};

namespace {

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

// Parses `text` into `root`. Duplicate keys, of which the last one counts, are added to `problems`. So is
// what ends the reading, after which `root` holds a part only and false is returned: what is not JSON,
// nesting deeper than `deepest`, more than `most_values`, or more than `most_parts`, which take far more
// memory than they are long.
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

// Each reads `value` into the target if it is allowed, and returns nothing. Else the target keeps what it
// has, and the result describes what is allowed.
using Wanted = std::optional<std::string>;

Wanted read_into(double& target, const Json& value, const NumberRange& range,
                 std::string_view kind = "a number") {
  if (!value.is_number() || !range.allows(value.get<double>())) return range.describe(kind);
  target = value.get<double>();
  return {};
}

Wanted read_into(std::optional<double>& target, const Json& value, const NumberRange& range) {
  double number = 0;
  if (!value.is_null())
    if (Wanted wanted = read_into(number, value, range, "null or a number")) return wanted;
  target = value.is_null() ? std::nullopt : std::optional(number);
  return {};
}

Wanted read_into(std::int64_t& target, const Json& value, const NumberRange& range) {
  // The parser stores non-negative numbers as unsigned, so the upper half must be rejected here.
  const bool is_too_large =
      value.is_number_unsigned() &&
      value.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()};
  if (value.is_number_integer() && !is_too_large && range.allows(value.get<std::int64_t>())) {
    target = value.get<std::int64_t>();
    return {};
  }
  const std::string wanted = range.describe("a whole number");
  if (!value.is_number_float()) return wanted;
  const auto number = value.get<double>();  // 3.0 and 3e0 are whole, but not written so
  const bool is_whole = number == std::floor(number) && std::abs(number) < 0x1p63 && range.allows(number);
  return is_whole ? wanted + ", written without point or exponent" : wanted;
}

Wanted read_into(std::string& target, const Json& value, const TextRule& rule) {
  if (!value.is_string() || !rule.allows(value.get_ref<const std::string&>())) return rule.describe();
  target = value.get_ref<const std::string&>();
  return {};
}

Wanted read_into(bool& target, const Json& value, const NumberRange&) {
  if (!value.is_boolean()) return "true or false";
  target = value.get<bool>();
  return {};
}

[[noreturn]] void reject_length(const std::string& name, const FileKind& kind, const std::string& given) {
  throw InputError(name, {{"", "too long, allowed are " + std::to_string(kind.most_bytes) + " bytes for a " +
                                   std::string(kind.name) + ", got " + given}});
}

constexpr std::size_t any_length = std::numeric_limits<std::size_t>::max();

// Control characters break lines and tables; 0x7f is one too.
bool is_control(char c) { return static_cast<unsigned char>(c) < 0x20 || c == 0x7f; }
bool is_alphanumeric(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}
// Whether a byte of UTF-8 begins a character, rather than continues one.
bool begins_character(char c) { return (static_cast<unsigned char>(c) & 0xc0) != 0x80; }

}  // namespace

bool TextRule::allows(std::string_view text) const {
  const auto length = static_cast<std::size_t>(std::count_if(text.begin(), text.end(), begins_character));
  if (length < least || length > most) return false;
  if (!is_name) return std::none_of(text.begin(), text.end(), is_control);
  return is_alphanumeric(text.front()) && std::all_of(text.begin(), text.end(), [](char c) {
           return is_alphanumeric(c) || c == '-' || c == '_' || c == '.';
         });
}

std::string TextRule::describe() const {
  const std::string longest = std::to_string(most) + " characters";
  if (is_name)
    return "a name of letters, digits, '-', '_' and '.', the first a letter or digit, of up to " + longest;
  return "a text of one line and " + (least > 0 ? std::to_string(least) + " to " : "up to ") + longest;
}

std::string read_text(const std::filesystem::path& file) { return read_text(file, {"file", any_length}); }

std::string read_text(const std::filesystem::path& file, const FileKind& kind) {
  const std::string name = file.string();
  std::error_code ignored, unknown;
  if (std::filesystem::is_directory(file, ignored)) throw IoError(name + ": cannot be read: is a directory");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  if (stream) {
    const auto size = std::filesystem::file_size(file, unknown);
    if (!unknown && size > kind.most_bytes) reject_length(name, kind, std::to_string(size));
    // A pipe has no size, and a file may grow while it is read. Growing by doubling would need three times as
    // much memory; what is reserved and not written takes none.
    std::vector<char> part(1 << 16);
    if (!unknown || kind.most_bytes < any_length)
      text.reserve((unknown ? kind.most_bytes : size) + part.size());
    while (text.size() <= kind.most_bytes && stream) {
      stream.read(part.data(), static_cast<std::streamsize>(part.size()));
      text.append(part.data(), static_cast<std::size_t>(stream.gcount()));
    }
    if (text.size() > kind.most_bytes) reject_length(name, kind, "more");
  }
  if (stream.bad() || !stream.is_open()) {
    throw IoError(name + ": cannot be read: " + std::strerror(errno ? errno : EIO));
  }
  return text;
}

JsonDocument::JsonDocument() = default;
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument& JsonDocument::operator=(JsonDocument&&) noexcept = default;
JsonDocument::~JsonDocument() = default;

JsonDocument JsonDocument::read(const std::filesystem::path& file, const FileKind& kind) {
  return parse(file.string(), read_text(file, kind));
}

JsonDocument JsonDocument::parse(const std::string& name, const std::string& text) {
  JsonDocument document;
  document.value_ = std::make_unique<Json>();
  document.problems_ = std::make_unique<JsonProblems>(name);
  if (!parse_json(text, *document.value_, *document.problems_)) document.problems_->throw_if_any();
  return document;
}

ObjectReader JsonDocument::root() {
  const bool is_object = value_->is_object();
  if (!is_object) problems_->add({}, "must be an object, got " + described(*value_));
  return {problems_.get(), {}, is_object ? value_.get() : nullptr};
}

void JsonDocument::finish() const { problems_->throw_if_any_or_unknown(); }

ObjectReader::ObjectReader(JsonProblems* problems, std::string pointer, const Json* object)
    : problems_(problems), pointer_(std::move(pointer)), object_(object) {
  if (object_) opened_ = problems_->open(pointer_, *object_);
}

const Json* ObjectReader::find(std::string_view key) {
  if (!object_) return nullptr;
  problems_->know(opened_, key);
  const auto found = object_->find(std::string(key));
  return found == object_->end() ? nullptr : &*found;
}

std::string ObjectReader::pointer_to(std::string_view key) const {
  return key.empty() ? pointer_ : pointer_ + '/' + json_token(key);
}

bool ObjectReader::holds(std::string_view key) const {
  return object_ && object_->contains(std::string(key));
}

bool ObjectReader::has(std::string_view key) { return find(key) != nullptr; }

bool ObjectReader::all_valid() const { return problems_->empty(); }

bool ObjectReader::require(std::string_view key) {
  if (has(key)) return true;
  if (object_) problems_->add(pointer_to(key), "missing, a value must be given");
  return false;
}

void ObjectReader::reject(std::string_view key, std::string_view what) {
  problems_->add(pointer_to(key), what);
}

void ObjectReader::reject(std::string_view key, std::size_t element, std::string_view what) {
  problems_->add(pointer_to(key) + '/' + std::to_string(element), what);
}

void ObjectReader::reject(const Problem& problem) {
  problems_->add(pointer_ + pointer_of(problem.field), problem.message);
}

std::vector<std::string> ObjectReader::keys() {
  std::vector<std::string> found;
  if (!object_) return found;
  for (const auto& item : object_->items()) {
    problems_->know(opened_, item.key());
    found.push_back(item.key());
  }
  return found;
}

void ObjectReader::suggest(std::string_view key) {
  if (object_) problems_->suggest(opened_, key);
}

bool ObjectReader::wrong(std::string_view key, const std::string& wanted, const Json& given) {
  reject(key, "must be " + wanted + ", got " + described(given));
  return false;
}

template <class Target>
requires(!Enumeration<Target>) bool ObjectReader::optional(std::string_view key, Target& target,
                                                           RuleFor<Target> rule) {
  const Json* const value = find(key);
  const Wanted wanted = value ? read_into(target, *value, rule) : std::nullopt;
  return !wanted || wrong(key, *wanted, *value);
}
template bool ObjectReader::optional(std::string_view, double&, NumberRange);
template bool ObjectReader::optional(std::string_view, std::optional<double>&, NumberRange);
template bool ObjectReader::optional(std::string_view, std::int64_t&, NumberRange);
template bool ObjectReader::optional(std::string_view, bool&, NumberRange);
template bool ObjectReader::optional(std::string_view, std::string&, TextRule);

bool ObjectReader::too_long(std::string_view key, std::size_t most, const Json& array) {
  if (array.size() <= most) return false;
  reject(key, "must have at most " + std::to_string(most) + " elements, got " + std::to_string(array.size()));
  return true;
}

template <class Element>
bool ObjectReader::optional(std::string_view key, std::vector<Element>& target, RuleFor<Element> rule) {
  const Json* const value = find(key);
  if (!value) return true;
  if (!value->is_array()) return wrong(key, "an array", *value);
  std::vector<Element> elements(value->size());
  bool all_read = true;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    const Wanted wanted = read_into(elements[i], (*value)[i], rule);
    if (!wanted) continue;
    all_read = false;
    reject(key, i, "must be " + *wanted + ", got " + described((*value)[i]));
  }
  if (all_read) target = std::move(elements);
  return all_read;
}
template bool ObjectReader::optional(std::string_view, std::vector<double>&, NumberRange);
template bool ObjectReader::optional(std::string_view, std::vector<std::optional<double>>&, NumberRange);
template bool ObjectReader::optional(std::string_view, std::vector<std::int64_t>&, NumberRange);
template bool ObjectReader::optional(std::string_view, std::vector<std::string>&, TextRule);

bool ObjectReader::optional(std::string_view key, std::vector<std::string>& target, TextRule rule,
                            std::size_t most) {
  const Json* const value = find(key);
  if (value && value->is_array() && too_long(key, most, *value)) return false;
  std::vector<std::string> texts;
  if (!optional(key, texts, rule)) return false;
  for (std::size_t i = 1; i < texts.size(); ++i) {
    const auto here = texts.begin() + static_cast<std::ptrdiff_t>(i);
    if (std::find(texts.begin(), here, *here) == here) continue;
    reject(key, i, "must differ from those before it, got the string " + in_quotes(*here));
    return false;
  }
  if (value) target = std::move(texts);
  return true;
}

bool ObjectReader::optional(std::string_view key, std::vector<std::array<double, 2>>& target,
                            std::size_t most) {
  const Json* const value = find(key);
  if (!value) return true;
  if (!value->is_array()) return wrong(key, "an array", *value);
  if (too_long(key, most, *value)) return false;
  std::vector<std::array<double, 2>> pairs(value->size());
  bool all_read = true;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    const Json& given = (*value)[i];
    const bool is_pair = given.is_array() && given.size() == 2;
    if (is_pair && !read_into(pairs[i][0], given[0], {}) && !read_into(pairs[i][1], given[1], {})) continue;
    all_read = false;
    reject(key, i, "must be an array of two numbers, got " + described(given));
  }
  if (all_read) target = std::move(pairs);
  return all_read;
}

bool ObjectReader::is_array(std::string_view key) const {
  return holds(key) && (*object_)[std::string(key)].is_array();
}
bool ObjectReader::is_text(std::string_view key) const {
  return holds(key) && (*object_)[std::string(key)].is_string();
}

std::optional<std::size_t> ObjectReader::word(std::string_view key,
                                              const std::vector<std::string_view>& words) {
  const Json* const value = find(key);
  if (!value) return std::nullopt;
  std::string list;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (value->is_string() && value->get_ref<const std::string&>() == words[i]) return i;
    list += (i == 0 ? "" : ", ") + in_quotes(words[i]);
  }
  constexpr std::size_t at_a_glance = 10;
  const std::string meant = value->is_string() && words.size() > at_a_glance
                                ? did_you_mean(value->get_ref<const std::string&>(), words, "\"")
                                : "";
  reject(key, meant.empty() ? "must be one of " + list + ", got " + described(*value)
                            : "unknown" + meant + " Got " + described(*value));
  return std::nullopt;
}

bool ObjectReader::words(std::string_view key, const std::vector<std::string_view>& words,
                         std::vector<std::size_t>& target) {
  std::vector<std::string> texts;
  if (!optional(key, texts)) return false;
  std::vector<std::size_t> indices;
  for (std::size_t i = 0; i < texts.size(); ++i) {
    const auto found = std::ranges::find(words, texts[i]);
    if (found == words.end()) {
      reject(key, i, "must be one of " + listed(words, "or") + ", got the string " + in_quotes(texts[i]));
      return false;
    }
    indices.push_back(static_cast<std::size_t>(found - words.begin()));
  }
  target = std::move(indices);
  return true;
}

std::optional<ObjectReader> ObjectReader::optional_object(std::string_view key) {
  const Json* const value = find(key);
  if (!value || value->is_null()) return std::nullopt;
  if (!value->is_object()) reject(key, "must be an object, got " + described(*value));
  return ObjectReader(problems_, pointer_to(key), value->is_object() ? value : nullptr);
}

ObjectReader ObjectReader::required_object(std::string_view key) {
  if (const auto object = optional_object(key)) return *object;
  if (require(key)) reject(key, "must be an object, got null");
  return {problems_, pointer_to(key), nullptr};
}

std::vector<ObjectReader> ObjectReader::optional_objects(std::string_view key, std::size_t most,
                                                         std::size_t least) {
  std::vector<ObjectReader> objects;
  const Json* const value = find(key);
  if (!value) return objects;
  if (!value->is_array()) {
    reject(key, "must be an array, got " + described(*value));
    return objects;
  }
  if (too_long(key, most, *value)) return objects;
  if (value->size() < least) {
    reject(key, "must have at least " + std::to_string(least) +
                    (least == 1 ? " element, got " : " elements, got ") + std::to_string(value->size()));
    return objects;
  }
  for (std::size_t i = 0; i < value->size(); ++i) {
    const Json& element = (*value)[i];
    std::string place = pointer_to(key) + '/' + std::to_string(i);
    if (!element.is_object()) problems_->add(place, "must be an object, got " + described(element));
    objects.push_back({problems_, std::move(place), element.is_object() ? &element : nullptr});
  }
  return objects;
}

}  // namespace impact_damper
