// Random numbers by index: each is a function of the seed, the index and the number that is drawn for, and of
// nothing else, so the order in which they are asked for, and by how many threads, changes nothing
// (docs/mathematics.md, chapter 15).
#pragma once

#include <array>
#include <cstdint>

namespace impact_damper {

// Philox4x32-10, four random words of 32 bits by counter and key: J.K. Salmon, M.A. Moraes, R.O. Dror and
// D.E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC11, doi 10.1145/2063384.2063405.
std::array<std::uint32_t, 4> philox(std::array<std::uint32_t, 4> counter, std::array<std::uint32_t, 2> key);

// Which random number: of which sequence, for which of the numbers that are drawn, and which one of them.
struct Draw {
  std::uint64_t seed = 0;
  std::uint32_t variable = 0;
  std::int64_t index = 0;  // >= 0
};
// Uniform in (0, 1) (M15.1).
double uniform_draw(const Draw& draw);
// The same for 0 <= index < count so that in each of `count` intervals of equal length lies one of the
// `count` numbers: one coordinate of a Latin hypercube (M15.2).
double stratified_draw(const Draw& draw, std::int64_t count);
// Where a random permutation of 0 ... count - 1 takes the index, 0 <= index < count <= 2^60.
std::int64_t permuted(const Draw& draw, std::int64_t count);

// The number that a normally distributed one of mean 0 and standard deviation 1 is below with probability p,
// 0 < p < 1 (M15.3).
double normal_quantile(double p);

}  // namespace impact_damper
