#include "impact_damper/base/number_text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

namespace impact_damper {
namespace {

template <typename Number>
std::optional<Number> parse_whole(std::string_view text) {
  Number value{};
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc{} || stop != end) return std::nullopt;
  return value;
}

// The numbers that tables are full of, 2^-10 <= |value| < 2^52 with a fraction, in less time than
// std::to_chars takes and to the same text.
//
// Let |value| = m 2^e, 2^52 <= m < 2^53. What lies within 2^(e-1) of it reads back as it. With 10^-q < 2^e <
// 10^(1-q) some multiples of 10^-q lie there, and at most one of 10^(1-q): that one, if there is one, is the
// shortest text once its zeros are off; if not, the multiple of 10^-q next to the value is. None lies at
// exactly 2^(e-1), which would take 1 - e decimals. (Below a power of two only half as much reads back as it,
// but those among these numbers that have a fraction are multiples of 10^(1-q) themselves.)
//
// Times 10^q 2^shift, shift = 1 - e - q, all of these are integers, the value below 2^99 and its distances
// from those multiples below 2^48.
constexpr int least_exponent = -62, most_decimals = 19;

constexpr auto powers_of(std::uint64_t base) {
  std::array<std::uint64_t, most_decimals + 1> powers{1};
  for (std::size_t i = 1; i < powers.size(); ++i) powers[i] = base * powers[i - 1];
  return powers;
}
constexpr auto powers_of_5 = powers_of(5), powers_of_10 = powers_of(10);

struct Decimal {
  std::uint64_t digits;  // by 10^-decimals, the last one not zero
  int decimals;          // >= 1
};
std::optional<Decimal> shortest_decimal(std::uint64_t bits) {
  __extension__ using Wide = unsigned __int128;
  constexpr std::uint64_t hidden_bit = std::uint64_t(1) << 52;
  const int e = static_cast<int>(bits >> 52 & 0x7ff) - 1075;
  if (e < least_exponent || e >= 0) return std::nullopt;
  const std::uint64_t m = (bits & (hidden_bit - 1)) | hidden_bit;
  int q = (-e * 1233 >> 12) + 1;  // 1233 / 4096 is log10(2), closely enough for 62 times it
  const int shift = 1 - e - q;
  const std::uint64_t reach = powers_of_5[static_cast<std::size_t>(q)];
  const Wide value = Wide(2 * m) * reach;
  const std::uint64_t one = std::uint64_t(1) << shift, units = static_cast<std::uint64_t>(value >> shift);
  const std::uint64_t tens = units / 10, rest = static_cast<std::uint64_t>(value) & (one - 1);
  const std::uint64_t from_ten = (units - 10 * tens) * one + rest;
  // Chosen without a branch, as either is as likely. Half way goes to the even number.
  const bool takes_lower_ten = from_ten < reach, takes_upper_ten = 10 * one - from_ten < reach;
  const bool takes_ten = takes_lower_ten | takes_upper_ten;
  const bool takes_upper_unit = 2 * rest + (units & 1) > one;
  std::uint64_t digits = takes_ten ? tens + takes_upper_ten : units + takes_upper_unit;
  q -= takes_ten;
  for (; digits % 10 == 0; digits /= 10) --q;
  if (q < 1) return std::nullopt;
  return Decimal{digits, q};
}

constexpr std::array<char, 200> make_pairs_of_digits() {
  std::array<char, 200> pairs{};
  for (std::size_t i = 0; i < pairs.size(); ++i)
    pairs[i] = static_cast<char>('0' + (i % 2 ? i / 2 % 10 : i / 20));
  return pairs;
}
constexpr std::array<char, 200> pairs_of_digits = make_pairs_of_digits();

// Four and eight digits, zeros in front; by halves, which do not wait for each other.
void write_four(char* at, std::uint32_t number) {
  std::copy_n(&pairs_of_digits[2 * std::size_t(number / 100)], 2, at);
  std::copy_n(&pairs_of_digits[2 * std::size_t(number % 100)], 2, at + 2);
}
void write_eight(char* at, std::uint32_t number) {
  write_four(at, number / 10'000);
  write_four(at + 4, number % 10'000);
}

// At most 40 characters.
char* write(char* at, const Decimal& decimal, double magnitude) {
  // What reads back as a number with a fraction has the same whole part as it.
  const auto whole = static_cast<std::uint64_t>(magnitude);
  at = std::to_chars(at, at + 16, whole).ptr;
  // All 19 decimals, the superfluous ones behind the end: no branch depends on their number.
  const auto q = static_cast<std::size_t>(decimal.decimals);
  const std::uint64_t fraction = (decimal.digits - whole * powers_of_10[q]) * powers_of_10[most_decimals - q];
  constexpr std::uint64_t eight_digits = 100'000'000;
  const std::uint64_t front = fraction / eight_digits;
  write_four(at, static_cast<std::uint32_t>(front / eight_digits));
  write_eight(at + 4, static_cast<std::uint32_t>(front % eight_digits));
  write_eight(at + 12, static_cast<std::uint32_t>(fraction % eight_digits));
  *at = '.';
  return at + 1 + q;
}

}  // namespace

void append_number(std::string& text, double value) {
  if (value == 0 && std::signbit(value)) {
    text += "-0.0";
    return;
  }
  char digits[40];
  const std::uint64_t bits = std::bit_cast<std::uint64_t>(value);
  if (const auto decimal = shortest_decimal(bits)) {
    digits[0] = '-';
    char* const begin = digits + (bits >> 63);
    text.append(digits, write(begin, *decimal, std::abs(value)));
  } else {
    text.append(digits, std::to_chars(digits, digits + sizeof digits, value).ptr);
  }
}

void append_number(std::string& text, std::int64_t value) {
  char digits[24];
  const auto [end, error] = std::to_chars(digits, digits + sizeof digits, value);
  text.append(digits, end);
}

std::string number_text(double value) {
  std::string text;
  append_number(text, value);
  return text;
}

std::string rounded_text(double value, int digits) {
  char text[40];
  return {text, std::to_chars(text, text + sizeof text, value, std::chars_format::general, digits).ptr};
}

std::optional<double> parse_number(std::string_view text) {
  const std::optional<double> value = parse_whole<double>(text);
  if (!value || !std::isfinite(*value)) return std::nullopt;
  return value;
}

std::optional<std::int64_t> parse_integer(std::string_view text) { return parse_whole<std::int64_t>(text); }

}  // namespace impact_damper
