// Random numbers by index: each is a function of the seed, the index and the variable alone. So neither the
// order in which they are drawn nor the number of threads changes them (docs/mathematics.md, chapter 15).
#pragma once

#include <array>
#include <cstdint>

namespace impact_damper {

// Philox4x32-10, four random words of 32 bits by counter and key: J.K. Salmon, M.A. Moraes, R.O. Dror and
// D.E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11, doi 10.1145/2063384.2063405.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

// Identifies a random number: the sequence, the variable that is drawn, and which of its draws.
struct Draw {
  std::uint64_t seed = 0;
  std::uint32_t variable = 0;
  std::int64_t index = 0;  // >= 0
};
// Returns a number that is uniform in (0, 1) (M15.1).
double uniform_draw(const Draw& draw);
// Returns one for 0 <= index < count such that each of `count` intervals of equal length contains one of the
// `count` numbers: one coordinate of a Latin hypercube (M15.2).
double stratified_draw(const Draw& draw, std::int64_t count);
// Returns the image of the index under a random permutation of 0 ... count - 1, 0 <= index < count <= 2^60.
std::int64_t permuted(const Draw& draw, std::int64_t count);

// Returns the quantile of the standard normal distribution for the probability p, 0 < p < 1 (M15.3).
double normal_quantile(double p);

}  // namespace impact_damper
