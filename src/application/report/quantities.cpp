#include "application/report/quantities.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "impact_damper/base/number_text.hpp"

namespace impact_damper {
namespace {

constexpr const char* no_break = "\u00a0";  // a space at which no line ends

std::string data_html(const std::string& exact, const std::string& shown) {
  return "<data value=\"" + exact + "\">" + shown + "</data>";
}

// Replaces a hyphen by a minus, and "1e+06" by a power of ten.
std::string typeset(std::string text) {
  std::string power;
  if (const std::size_t e = text.find('e'); e != std::string::npos) {
    std::int64_t exponent = 0;
    const std::size_t digits = text[e + 1] == '+' ? e + 2 : e + 1;
    const bool negative = text[digits] == '-';
    for (std::size_t i = digits + negative; i < text.size(); ++i) exponent = 10 * exponent + (text[i] - '0');
    power = "×10<sup>" + std::string(negative ? "−" : "") + std::to_string(exponent) + "</sup>";
    text.resize(e);
  }
  if (text.starts_with('-')) text.replace(0, 1, "−");
  return text + power;
}

}  // namespace

std::string escaped(std::string_view text) {
  constexpr std::array<std::pair<char, std::string_view>, 4> entities{
      {{'&', "&amp;"}, {'<', "&lt;"}, {'>', "&gt;"}, {'"', "&quot;"}}};
  std::string html;
  for (const char c : text) {
    const auto* const entity = std::ranges::find(entities, c, &std::pair<char, std::string_view>::first);
    html += entity == entities.end() ? std::string_view(&c, 1) : entity->second;
  }
  return html;
}

std::string without_tags(const std::string& html) {
  std::string text;
  bool in_tag = false;
  for (const char c : html) {
    if (c == '<') in_tag = true;
    if (!in_tag) text += c;
    if (c == '>') in_tag = false;
  }
  return text;
}

std::string number_html(double value, int digits) {
  const double size = std::abs(value);
  double power = 1;  // of ten: from here on all the digits are before the point
  for (int i = 0; i < digits; ++i) power *= 10;
  const bool whole = size >= power - 0.5 && size < 1e6 - 0.5;
  return data_html(number_text(value),
                   typeset(rounded_text(whole ? std::round(value) : value, whole ? 7 : digits)));
}

std::string count_html(std::int64_t count) { return data_html(std::to_string(count), std::to_string(count)); }

std::string percent_html(double part) { return number_html(100 * part) + no_break + "%"; }

std::string Quantities::both(double value, double scale, std::string_view unit, std::string_view by,
                             int digits) const {
  std::string plain = number_html(value, digits) + no_break + std::string(by);
  if (!scales_) return plain;
  return number_html(value * scale, digits) + no_break + std::string(unit) + " (" + plain + ')';
}

std::string Quantities::length(double value) const {
  constexpr double small = 0.1;  // mm
  const double its = scale(Dimension::length);
  if (value != 0 && std::abs(value * its) < small) return both(value, 1e3 * its, "µm", "ε");
  return both(value, its, "mm", "ε");
}

std::string Quantities::time(double value) const {
  const std::string periods = number_html(value / (2 * std::numbers::pi)) + " periods";
  if (!scales_) return periods + " (<i>t</i> = " + number_html(value) + ')';
  return number_html(value * scale(Dimension::time)) + no_break + "s (" + periods + ')';
}

std::string paragraph_html(const std::string& text) { return "<p>" + text + "</p>\n"; }

std::string table_html(const HtmlTable& table) {
  std::string html = "<div class=\"wide\"><table>\n<caption>" + table.caption + "</caption>\n<thead><tr>";
  for (const std::string& head : table.heads) html += "<th scope=\"col\">" + head + "</th>";
  html += "</tr></thead>\n<tbody>\n";
  for (const auto& row : table.rows) {
    html += "<tr>";
    for (std::size_t i = 0; i < row.size(); ++i)
      html += i == 0 ? "<th scope=\"row\">" + row[i] + "</th>" : "<td>" + row[i] + "</td>";
    html += "</tr>\n";
  }
  return html + "</tbody></table></div>\n";
}

}  // namespace impact_damper
