// SHA-256 (FIPS 180-4).
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace impact_damper {

// The digest of the bytes of `text`: 64 hexadecimal digits in lower case.
std::string sha256(std::string_view text);

// Computes the digest of a text that comes in pieces.
class Sha256 {
 public:
  void add(std::string_view text);
  std::string digest() const;  // of all that was added so far

 private:
  void add_block(const char* bytes);

  std::array<std::uint32_t, 8> state_{0x6a09e667, 0xbb67ae85, 0x3c6ef372, 0xa54ff53a,
                                      0x510e527f, 0x9b05688c, 0x1f83d9ab, 0x5be0cd19};
  std::uint64_t bytes_ = 0;
  std::string begun_;  // the last, incomplete block
};

}  // namespace impact_damper
