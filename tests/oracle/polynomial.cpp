#include "polynomial.hpp"

#include <algorithm>

namespace oracle {
namespace {

// Half a unit in the last place of 1.
template <class T>
constexpr T rounding = T(0);
template <>
constexpr long double rounding<long double> = 0x1p-64L;
template <>
constexpr Quad rounding<Quad> = Quad(0x1p-113L);

template <class T>
T absolute(T x) {
  return x < 0 ? -x : x;
}

template <class T>
using Coefficients = std::array<T, Polynomial::most + 1>;

// p = sum of b[j] C(n, j) s^j (1-s)^(n-j).
template <class T>
Coefficients<T> bernstein(const Polynomial& p) {
  Coefficients<T> b{};
  T binomial = 1;
  for (int i = 0; i <= p.degree; ++i) {
    b[i] = T(p.at[i]) / binomial;
    binomial = binomial * T(p.degree - i) / T(i + 1);
  }
  for (int r = 1; r <= p.degree; ++r)
    for (int j = p.degree; j >= r; --j) b[j] += b[j - 1];
  return b;
}

// Cuts b at its middle by de Casteljau's scheme: returns the left half's coefficients, leaves the right
// half's in b, where the last entry of each row of the scheme stays behind.
template <class T>
Coefficients<T> left_half(Coefficients<T>& b, int degree) {
  Coefficients<T> left{};
  for (int r = 0; r <= degree; ++r) {
    left[r] = b[0];
    for (int j = 0; j < degree - r; ++j) b[j] = (b[j] + b[j + 1]) / 2;
  }
  return left;
}

// The root in (low, high], where p is monotone and has these signs at the ends.
Quad refined(const Polynomial& p, Quad low, Quad high, int sign_low) {
  Quad s = (low + high) / 2;
  for (int i = 0; i < 300; ++i) {
    Quad value = p.at[p.degree], slope = 0;
    for (int n = p.degree; n-- > 0;) {
      slope = slope * s + value;
      value = value * s + p.at[n];
    }
    const int sign = sign_of(value);
    if (sign == 0) return s;
    if (sign == sign_low)
      low = s;
    else
      high = s;
    Quad next = slope != 0 ? s - value / slope : low;
    if (!(next > low && next < high)) {
      // Newton's step from within a rounding of the root leaves the bracket by as little: done.
      if (slope != 0 && magnitude(value / slope) <= magnitude(s) * Quad(0x1p-111L)) return s;
      next = (low + high) / 2;
    }
    if (magnitude(next - s) <= magnitude(s) * Quad(0x1p-112L)) return next;
    s = next;
  }
  return s;
}

struct Search {
  const Polynomial& p;
  std::vector<Root>& roots;

  void monotone(Quad low, Quad high) {
    const int before = sign_of(p(low)), after = sign_of(p(high));
    if (before == 0 || before == after) return;  // a root at `low` belongs to the interval before
    const Quad s = after == 0 ? high : refined(p, low, high, before);
    roots.push_back({s, -before});
  }

  // The undecided intervals of [low, low + width] where a coarser arithmetic gives up.
  template <class T>
  void isolate(Coefficients<T> b, Quad low, Quad width, T error, int depth, int deepest,
               std::vector<std::array<Quad, 2>>* undecided) {
    const int n = p.degree;
    bool positive = true, negative = true, nothing = true, rises = true, falls = true;
    for (int j = 0; j <= n; ++j) {
      positive = positive && b[j] > error;
      negative = negative && b[j] < -error;
      nothing = nothing && absolute(b[j]) <= error;
      if (j == n) break;
      rises = rises && b[j + 1] - b[j] > 2 * error;
      falls = falls && b[j] - b[j + 1] > 2 * error;
    }
    if (positive || negative) return;
    if (rises || falls) return monotone(low, low + width);
    if (nothing || depth == deepest) {
      if (undecided)
        undecided->push_back({low, width});
      else
        monotone(low, low + width);  // zero within rounding: a change of sign if its ends say so
      return;
    }
    const Coefficients<T> left = left_half(b, n);
    isolate(left, low, width / 2, error, depth + 1, deepest, undecided);
    isolate(b, low + width / 2, width / 2, error, depth + 1, deepest, undecided);
  }
};

// p on [low, low + width], stretched to [0, 1].
Polynomial stretched(const Polynomial& p, Quad low, Quad width) {
  Polynomial q = p;
  for (int i = 0; i < q.degree; ++i)  // Taylor's shift by Horner's scheme
    for (int n = q.degree - 1; n >= i; --n) q.at[n] += low * q.at[n + 1];
  Quad power = 1;
  for (int n = 0; n <= q.degree; ++n) {
    q.at[n] *= power;
    power *= width;
  }
  return q;
}

}  // namespace

Polynomial derivative(const Polynomial& p) {
  Polynomial d;
  d.degree = std::max(p.degree - 1, 0);
  for (int n = 0; n < p.degree; ++n) d.at[n] = (n + 1) * p.at[n + 1];
  return d;
}

Polynomial divided_by_power(const Polynomial& p, int power) {
  Polynomial q;
  q.degree = p.degree - power;
  for (int n = 0; n <= q.degree; ++n) q.at[n] = p.at[n + power];
  return q;
}

Quad integral_of_product(const Polynomial& p, const Polynomial& q, Quad s) {
  // Products below 1e-31 of the largest are not worth their time.
  const long double least =
      static_cast<long double>(p.sum_of_magnitudes() * q.sum_of_magnitudes() * Quad(1e-32L));
  std::array<long double, Polynomial::most + 1> rough_p, rough_q;
  for (int i = 0; i <= p.degree; ++i) rough_p[i] = static_cast<long double>(magnitude(p.at[i]));
  for (int j = 0; j <= q.degree; ++j) rough_q[j] = static_cast<long double>(magnitude(q.at[j]));
  std::array<Quad, 2 * Polynomial::most + 2> sums{};
  for (int i = 0; i <= p.degree; ++i)
    for (int j = 0; j <= q.degree; ++j) {
      if (rough_p[i] * rough_q[j] > least) sums[i + j + 1] += p.at[i] * q.at[j];
    }
  Quad sum = 0;
  for (int n = p.degree + q.degree + 1; n > 0; --n) sum = (sum + sums[n] / n) * s;
  return sum;
}

std::vector<Root> changes_of_sign(const Polynomial& p) {
  std::vector<Root> roots;
  const Quad size = p.sum_of_magnitudes();
  if (size == 0) return roots;
  Search search{p, roots};
  std::vector<std::array<Quad, 2>> undecided;
  // Sums of n additions each, of magnitudes below size, and halvings that round as often again.
  const long double error = rounding<long double> * 4 * (p.degree + 8) * static_cast<long double>(size);
  search.isolate<long double>(bernstein<long double>(p), 0, 1, error, 0, 20, &undecided);
  for (const auto& [low, width] : undecided) {
    const Polynomial q = stretched(p, low, width);
    const Quad q_size = q.sum_of_magnitudes();
    // Coefficients of the stretched polynomial carry the roundings of the shift.
    const Quad q_error = rounding<Quad> * 4 * (p.degree + 8) * (size + q_size);
    search.isolate<Quad>(bernstein<Quad>(q), low, width, q_error, 20, 100, nullptr);
  }
  std::sort(roots.begin(), roots.end(), [](const Root& a, const Root& b) { return a.s < b.s; });
  return roots;
}

}  // namespace oracle
