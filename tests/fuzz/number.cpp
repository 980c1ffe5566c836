// What is read as a number is finite, is what the C library makes of it, and is written so that it reads back
// as the same bits. A fuzzer's other inputs are bits of a number, which has to stand the same.
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>

#include "fuzz.hpp"
#include "impact_damper/base/number_text.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace impact_damper;
  const auto stands = [](double value) {
    const std::optional<double> again = parse_number(number_text(value));
    fuzz::require(again && std::bit_cast<std::uint64_t>(*again) == std::bit_cast<std::uint64_t>(value));
  };
  const std::string text(reinterpret_cast<const char*>(data), size);
  if (const std::optional<double> value = parse_number(text)) {
    fuzz::require(std::isfinite(*value) && std::strtod(text.c_str(), nullptr) == *value);
    stands(*value);
  }
  if (const std::optional<std::int64_t> value = parse_integer(text)) {
    std::string again;
    append_number(again, *value);
    fuzz::require(parse_integer(again) == value);
  }
  if (double value = 0; size == sizeof value) {
    std::memcpy(&value, data, sizeof value);
    if (std::isfinite(value)) stands(value);
  }
  return 0;
}
