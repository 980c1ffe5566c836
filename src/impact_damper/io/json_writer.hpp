// Writes JSON as text; the only writer of the project. It is written directly: a run may hold a million
// numbers, and the order and the lines of the keys are part of the formats. Numbers read back with the same
// bits (number_text.hpp).
#pragma once

#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "impact_damper/base/enumeration.hpp"
#include "impact_damper/base/errors.hpp"
#include "impact_damper/base/number_text.hpp"

namespace impact_damper {

class JsonWriter {
 public:
  // Whether the elements of an object or array are on lines of their own or all on one.
  enum class Layout { lines, one_line };

  explicit JsonWriter(std::string_view of) : of_(of) {}  // of: what is written, for messages

  void open_object(Layout layout) {  // as an element of an array, or as the whole
    separate();
    begin('{', layout);
  }
  void open_object(std::string_view name, Layout layout) {
    key(name);
    begin('{', layout);
  }
  void open_array(std::string_view name, Layout layout) {
    key(name);
    begin('[', layout);
  }
  void close() {
    const Level level = levels_.back();
    levels_.pop_back();
    if (level.layout == Layout::lines) break_line();
    text_ += level.end;
  }
  Layout layout() const { return levels_.back().layout; }  // of the object or array that is open
  void new_line() { breaks_ = true; }                      // for the next field, whatever the layout

  // Writes a field. Throws NumericalError, naming it, if a number is not finite: JSON has none.
  template <typename Value>
  void field(std::string_view name, const Value& given) {
    key(name);
    value(given);
  }
  // Writes an array: numbers without blanks, texts with blanks between.
  template <typename Element>
  void field(std::string_view name, const std::vector<Element>& elements) {
    key(name);
    text_ += '[';
    for (std::size_t i = 0; i < elements.size(); ++i) {
      if (i > 0) text_ += std::convertible_to<Element, std::string_view> ? ", " : ",";
      value(elements[i]);
    }
    text_ += ']';
  }

  // Writes fields from names and values in alternation.
  template <typename Value, typename... More>
  void fields(std::string_view name, const Value& given, const More&... more) {
    field(name, given);
    if constexpr (sizeof...(more) > 0) fields(more...);
  }
  // Writes a whole object of such fields.
  template <typename... NamesAndValues>
  void object(std::string_view name, Layout layout, const NamesAndValues&... given) {
    open_object(name, layout);
    fields(given...);
    close();
  }

  // Writes an array of objects, each on one line; write(element) writes its fields.
  template <typename Elements, typename Write>
  void objects(std::string_view name, Layout layout, const Elements& elements, Write write) {
    open_array(name, layout);
    for (const auto& element : elements) {
      open_object(Layout::one_line);
      write(element);
      close();
    }
    close();
  }

  std::string finish() { return std::move(text_); }

 private:
  struct Level {
    char end;
    Layout layout;
    bool empty = true;
  };

  void separate() {
    if (levels_.empty()) return;
    Level& level = levels_.back();
    const bool breaks = breaks_ || level.layout == Layout::lines;
    if (!level.empty) text_ += breaks ? "," : ", ";
    if (breaks) break_line();
    level.empty = breaks_ = false;
  }
  void key(std::string_view name) {
    separate();
    value(name);
    text_ += ": ";
    name_ = name;
  }
  void begin(char bracket, Layout layout) {
    text_ += bracket;
    levels_.push_back({bracket == '{' ? '}' : ']', layout});
  }
  void break_line() {
    text_ += '\n';
    text_.append(levels_.size(), ' ');
  }

  void value(double number) {
    if (!std::isfinite(number)) {
      throw NumericalError("a number in \"" + name_ + "\" of the " + of_ +
                           " is not finite: " + number_text(number));
    }
    append_number(text_, number);
  }
  void value(const std::optional<double>& number) {
    if (number) {
      value(*number);
    } else {
      text_ += "null";
    }
  }
  void value(const std::array<double, 2>& pair) {
    text_ += '[';
    value(pair[0]);
    text_ += ',';
    value(pair[1]);
    text_ += ']';
  }
  void value(std::int64_t number) { append_number(text_, number); }
  void value(Enumeration auto enumerator) { value(name_of(enumerator)); }
  void value(std::same_as<bool> auto flag) { text_ += flag ? "true" : "false"; }
  void value(std::string_view text) {  // of one line: the readers allow no control character
    text_ += '"';
    for (const char c : text) {
      if (c == '"' || c == '\\') text_ += '\\';
      text_ += c;
    }
    text_ += '"';
  }

  std::string of_, text_;
  std::string name_;  // of the field being written, for messages
  std::vector<Level> levels_;
  bool breaks_ = false;
};

}  // namespace impact_damper
