#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "impact_damper/math/elementary.hpp"
#include "measurements.hpp"

namespace impact_damper::bench {
namespace {

using Arguments = std::array<double, 1024>;

// Spread over [low, high] out of order, as a processor that learns them would find them too easy.
Arguments arguments_between(double low, double high) {
  Arguments all;
  std::uint64_t state = 1;
  for (double& argument : all) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    argument = low + (high - low) * (double(state >> 11) * 0x1p-53);
  }
  return all;
}

template <class Function>
double seconds_of_a_call(const Arguments& arguments, const Function& function) {
  constexpr int rounds = 20;
  [[maybe_unused]] static volatile double sink;
  return cpu_seconds([&] {
           double result = 0;
           for (int i = 0; i < rounds; ++i) {
             for (const double argument : arguments) result = function(argument + 1e-9 * result);
           }
           sink = result;
         }) /
         (rounds * double(arguments.size()));
}

double ulps(double got, long double exact) {
  int exponent;
  std::frexp(double(exact), &exponent);
  return double(std::fabs(std::ldexp(got - exact, 53 - exponent)));
}

// `own` and `library` make of an argument one number, and `errors` the error of each: an array of two.
template <class Own, class Library, class Errors>
FunctionCost measure_function(FunctionCost cost, double low, double high, int repeats, const Own& own,
                              const Library& library, const Errors& errors) {
  const Arguments arguments = arguments_between(low, high);
  std::vector<double> own_seconds, library_seconds, ratios;
  for (int i = 0; i < repeats; ++i) {
    own_seconds.push_back(seconds_of_a_call(arguments, own));
    library_seconds.push_back(seconds_of_a_call(arguments, library));
    ratios.push_back(own_seconds.back() / library_seconds.back());
  }
  cost.own = spread_of(own_seconds);
  cost.library = spread_of(library_seconds);
  cost.ratio = spread_of(ratios);
  for (const double argument : arguments) {
    const auto [own_error, library_error] = errors(argument);
    cost.own_error = std::max(cost.own_error, own_error);
    cost.library_error = std::max(cost.library_error, library_error);
  }
  return cost;
}

}  // namespace

std::vector<FunctionCost> measure_functions(int repeats) {
  std::vector<FunctionCost> all;
  const auto add = [&](FunctionCost cost, double low, double high, const auto& own, const auto& library) {
    const auto errors = [&](double x) {
      const auto exact = library(static_cast<long double>(x));
      return std::array{ulps(own(x), exact), ulps(library(x), exact)};
    };
    all.push_back(measure_function(std::move(cost), low, high, repeats, own, library, errors));
  };
  const auto both = [&](const std::string& name, double reach) {
    const auto own = [](double x) {
      const auto [sin, cos] = sin_cos(x);
      return sin + cos;
    };
    const auto library = [](double x) {
      double sin, cos;
      ::sincos(x, &sin, &cos);
      return sin + cos;
    };
    const auto errors = [](double x) {
      const auto [sin, cos] = sin_cos(x);
      const long double s = std::sin(static_cast<long double>(x)), c = std::cos(static_cast<long double>(x));
      return std::array{std::max(ulps(sin, s), ulps(cos, c)),
                        std::max(ulps(std::sin(x), s), ulps(std::cos(x), c))};
    };
    all.push_back(measure_function({"sine and cosine", name}, -reach, reach, repeats, own, library, errors));
  };
  both("-2π to 2π", 6.283185);
  both("-1000 to 1000", 1000);
  add(
      {"exponential", "-1 to 0"}, -1, 0, [](double x) { return exponential(x); },
      [](auto x) { return std::exp(x); });
  add(
      {"exponential minus 1", "-1 to 0"}, -1, 0, [](double x) { return exponential_minus_1(x); },
      [](auto x) { return std::expm1(x); });
  add(
      {"logarithm", "0.1 to 10"}, 0.1, 10, [](double x) { return logarithm(x); },
      [](auto x) { return std::log(x); });
  add(
      {"angle of a point", "y from -1 to 1, x = 0.4"}, -1, 1, [](double y) { return angle_of(y, 0.4); },
      [](auto y) { return std::atan2(y, decltype(y)(0.4)); });
  return all;
}

}  // namespace impact_damper::bench
