// Two numbers that undergo the same operations: one instruction for both, where the processor has it.
#pragma once

#include <array>
#include <cstddef>

namespace impact_damper {

template <class Real>
struct SimdPairOf {
  class Type {
   public:
    Type() = default;
    Type(const Real& first, const Real& second) : both_{first, second} {}
    const Real& operator[](std::size_t i) const { return both_[i]; }
    friend Type operator+(const Type& a, const Type& b) { return {a[0] + b[0], a[1] + b[1]}; }
    friend Type operator-(const Type& a, const Type& b) { return {a[0] - b[0], a[1] - b[1]}; }
    friend Type operator*(const Type& a, const Type& b) { return {a[0] * b[0], a[1] * b[1]}; }
    friend Type operator*(const Type& a, const Real& b) { return {a[0] * b, a[1] * b}; }
    friend Type operator/(const Type& a, const Real& b) { return {a[0] / b, a[1] / b}; }

   private:
    std::array<Real, 2> both_{};
  };
};
template <>
struct SimdPairOf<double> {
  using Type [[gnu::vector_size(16)]] = double;
};
template <class Real>
using SimdPair = typename SimdPairOf<Real>::Type;

}  // namespace impact_damper
