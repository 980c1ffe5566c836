#include "impact_damper/files/json_reader.hpp"

#include <cerrno>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "impact_damper/files/json_parser.hpp"
#include "impact_damper/files/number_text.hpp"

namespace impact_damper {
namespace {

using Json = nlohmann::json;

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
    case Json::value_t::number_float:
      return number_text(value.get<double>());
    case Json::value_t::binary:
    case Json::value_t::discarded:
      break;
  }
  return "nothing";
}

// Each read_into says whether `value` is admitted, and only then writes the target.
bool read_into(double& target, const Json& value, const NumberRange& range) {
  if (!value.is_number()) return false;
  const double number = value.get<double>();
  if (!range.admits(number)) return false;
  target = number;
  return true;
}

bool read_into(std::optional<double>& target, const Json& value, const NumberRange& range) {
  if (value.is_null()) {
    target.reset();
    return true;
  }
  double number = 0;
  if (!read_into(number, value, range)) return false;
  target = number;
  return true;
}

bool read_into(std::int64_t& target, const Json& value, const NumberRange& range) {
  // Whatever is not negative is kept as unsigned by the parser, so the upper half must be refused here.
  if (!value.is_number_integer()) return false;
  if (value.is_number_unsigned() &&
      value.get<std::uint64_t>() > std::uint64_t{std::numeric_limits<std::int64_t>::max()}) {
    return false;
  }
  const auto number = value.get<std::int64_t>();
  if (!range.admits(static_cast<double>(number))) return false;
  target = number;
  return true;
}

bool read_into(std::string& target, const Json& value) {
  if (!value.is_string()) return false;
  target = value.get_ref<const std::string&>();
  return true;
}

bool read_into(bool& target, const Json& value) {
  if (!value.is_boolean()) return false;
  target = value.get<bool>();
  return true;
}

}  // namespace

std::string read_text(const std::filesystem::path& file) {
  const std::string name = file.string();
  std::error_code ignored;
  if (std::filesystem::is_directory(file, ignored)) throw IoError(name + ": cannot be read: is a directory");
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::string text;
  if (stream) text.assign(std::istreambuf_iterator<char>(stream), {});
  if (!stream) throw IoError(name + ": cannot be read: " + std::strerror(errno ? errno : EIO));
  return text;
}

JsonDocument::JsonDocument() = default;
JsonDocument::JsonDocument(JsonDocument&&) noexcept = default;
JsonDocument& JsonDocument::operator=(JsonDocument&&) noexcept = default;
JsonDocument::~JsonDocument() = default;

JsonDocument JsonDocument::read(const std::filesystem::path& file) {
  return parse(file.string(), read_text(file));
}

JsonDocument JsonDocument::parse(std::string name, const std::string& text) {
  JsonDocument document;
  document.value_ = std::make_unique<Json>();
  document.problems_ = std::make_unique<JsonProblems>(std::move(name));
  parse_json(text, *document.value_, *document.problems_);
  document.problems_->throw_if_any();
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

bool ObjectReader::has(std::string_view key) { return find(key) != nullptr; }

bool ObjectReader::require(std::string_view key) {
  if (has(key)) return true;
  if (object_) problems_->add(pointer_to(key), "missing, a value must be given");
  return false;
}

void ObjectReader::refuse(std::string_view key, std::string_view what) {
  problems_->add(pointer_to(key), what);
}

void ObjectReader::refuse(std::string_view key, std::size_t element, std::string_view what) {
  problems_->add(pointer_to(key) + '/' + std::to_string(element), what);
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

bool ObjectReader::wrong(std::string_view key, const std::string& wanted, const Json& given) {
  refuse(key, "must be " + wanted + ", got " + described(given));
  return false;
}

bool ObjectReader::optional(std::string_view key, double& target, NumberRange range) {
  const Json* const value = find(key);
  return !value || read_into(target, *value, range) || wrong(key, range.describe("a number"), *value);
}

bool ObjectReader::optional(std::string_view key, std::int64_t& target, NumberRange range) {
  const Json* const value = find(key);
  return !value || read_into(target, *value, range) || wrong(key, range.describe("a whole number"), *value);
}

bool ObjectReader::optional(std::string_view key, std::optional<double>& target, NumberRange range) {
  const Json* const value = find(key);
  return !value || read_into(target, *value, range) || wrong(key, range.describe("null or a number"), *value);
}

bool ObjectReader::optional(std::string_view key, bool& target) {
  const Json* const value = find(key);
  return !value || read_into(target, *value) || wrong(key, "true or false", *value);
}

bool ObjectReader::optional(std::string_view key, std::string& target) {
  const Json* const value = find(key);
  return !value || read_into(target, *value) || wrong(key, "a string", *value);
}

template <typename Element, typename... Range>
bool ObjectReader::array(std::string_view key, std::vector<Element>& target,
                         const std::string& wanted_element, const Range&... range) {
  const Json* const value = find(key);
  if (!value) return true;
  if (!value->is_array()) return wrong(key, "an array", *value);
  std::vector<Element> elements(value->size());
  bool all_read = true;
  for (std::size_t i = 0; i < elements.size(); ++i) {
    if (read_into(elements[i], (*value)[i], range...)) continue;
    all_read = false;
    refuse(key, i, "must be " + wanted_element + ", got " + described((*value)[i]));
  }
  if (all_read) target = std::move(elements);
  return all_read;
}

bool ObjectReader::optional(std::string_view key, std::vector<double>& target, NumberRange range) {
  return array(key, target, range.describe("a number"), range);
}

bool ObjectReader::optional(std::string_view key, std::vector<std::int64_t>& target, NumberRange range) {
  return array(key, target, range.describe("a whole number"), range);
}

bool ObjectReader::optional(std::string_view key, std::vector<std::optional<double>>& target,
                            NumberRange range) {
  return array(key, target, range.describe("null or a number"), range);
}

bool ObjectReader::optional(std::string_view key, std::vector<std::string>& target) {
  return array(key, target, "a string");
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
  refuse(key, "must be one of " + list + ", got " + described(*value));
  return std::nullopt;
}

std::optional<ObjectReader> ObjectReader::optional_object(std::string_view key) {
  const Json* const value = find(key);
  if (!value || value->is_null()) return std::nullopt;
  if (!value->is_object()) refuse(key, "must be an object, got " + described(*value));
  return ObjectReader(problems_, pointer_to(key), value->is_object() ? value : nullptr);
}

ObjectReader ObjectReader::required_object(std::string_view key) {
  if (const auto object = optional_object(key)) return *object;
  if (require(key)) refuse(key, "must be an object, got null");
  return {problems_, pointer_to(key), nullptr};
}

std::vector<ObjectReader> ObjectReader::optional_objects(std::string_view key) {
  std::vector<ObjectReader> objects;
  const Json* const value = find(key);
  if (!value) return objects;
  if (!value->is_array()) {
    refuse(key, "must be an array, got " + described(*value));
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
