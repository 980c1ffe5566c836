// What this project uses of the C++20 library and LLVM's version 13 does not have, the one that Debian 12's
// emscripten compiles with. It is included before every source (CMakeLists.txt beside it), and only there.
#pragma once

#include <algorithm>
#include <functional>
#include <iterator>
#include <utility>
#include <version>

#if __cplusplus >= 202002L && defined(_LIBCPP_VERSION) && _LIBCPP_VERSION < 14000

namespace std {

template <class To, class From>
constexpr To bit_cast(const From& from) noexcept {
  return __builtin_bit_cast(To, from);
}

namespace ranges {

// A predicate or an order seen through a projection.
template <class Function, class Projection>
constexpr auto projected(Function& function, Projection& projection) {
  return [&](auto&&... each) -> decltype(auto) {
    return std::invoke(function, std::invoke(projection, std::forward<decltype(each)>(each))...);
  };
}

template <class Range, class Value, class Projection = std::identity>
constexpr auto find(Range&& range, const Value& value, Projection projection = {}) {
  return std::find_if(std::begin(range), std::end(range),
                      [&](auto&& each) { return std::invoke(projection, each) == value; });
}
template <class Range, class Value, class Projection = std::identity>
constexpr auto count(Range&& range, const Value& value, Projection projection = {}) {
  return std::count_if(std::begin(range), std::end(range),
                       [&](auto&& each) { return std::invoke(projection, each) == value; });
}

#define IMPACT_DAMPER_WITH_PREDICATE(name)                                                  \
  template <class Range, class Predicate, class Projection = std::identity>                 \
  constexpr auto name(Range&& range, Predicate predicate, Projection projection = {}) {     \
    return std::name(std::begin(range), std::end(range), projected(predicate, projection)); \
  }
IMPACT_DAMPER_WITH_PREDICATE(find_if)
IMPACT_DAMPER_WITH_PREDICATE(count_if)
IMPACT_DAMPER_WITH_PREDICATE(any_of)
IMPACT_DAMPER_WITH_PREDICATE(all_of)
IMPACT_DAMPER_WITH_PREDICATE(none_of)
#undef IMPACT_DAMPER_WITH_PREDICATE

#define IMPACT_DAMPER_WITH_ORDER(name)                                                  \
  template <class Range, class Order = std::less<>, class Projection = std::identity>   \
  constexpr auto name(Range&& range, Order order = {}, Projection projection = {}) {    \
    return std::name(std::begin(range), std::end(range), projected(order, projection)); \
  }
IMPACT_DAMPER_WITH_ORDER(sort)
IMPACT_DAMPER_WITH_ORDER(stable_sort)
IMPACT_DAMPER_WITH_ORDER(min_element)
IMPACT_DAMPER_WITH_ORDER(max_element)
#undef IMPACT_DAMPER_WITH_ORDER

template <class Range, class Value, class Order = std::less<>, class Projection = std::identity>
constexpr auto lower_bound(Range&& range, const Value& value, Order order = {}, Projection projection = {}) {
  return std::lower_bound(std::begin(range), std::end(range), value, [&](auto&& each, const Value& bound) {
    return std::invoke(order, std::invoke(projection, each), bound);
  });
}
template <class Range, class Value, class Order = std::less<>>
constexpr auto upper_bound(Range&& range, const Value& value, Order order = {}) {
  return std::upper_bound(std::begin(range), std::end(range), value, order);
}
template <class Range, class Value>
constexpr bool binary_search(Range&& range, const Value& value) {
  return std::binary_search(std::begin(range), std::end(range), value);
}

template <class Range>
constexpr auto min(Range&& range) {
  return *std::min_element(std::begin(range), std::end(range));
}
template <class Range>
constexpr auto max(Range&& range) {
  return *std::max_element(std::begin(range), std::end(range));
}
template <class Range>
constexpr auto minmax(Range&& range) {
  return std::pair(ranges::min(range), ranges::max(range));
}

template <class Range, class Out, class Function>
constexpr void transform(Range&& range, Out out, Function function) {
  std::transform(std::begin(range), std::end(range), out, [&](auto&& each) -> decltype(auto) {
    return std::invoke(function, std::forward<decltype(each)>(each));
  });
}
template <class Range, class Out>
constexpr void copy(Range&& range, Out out) {
  std::copy(std::begin(range), std::end(range), out);
}
template <class Range, class Out>
constexpr void move(Range&& range, Out out) {
  std::move(std::begin(range), std::end(range), out);
}
template <class Range, class Value>
constexpr void replace(Range&& range, const Value& old_value, const Value& new_value) {
  std::replace(std::begin(range), std::end(range), old_value, new_value);
}
template <class Range>
constexpr void reverse(Range&& range) {
  std::reverse(std::begin(range), std::end(range));
}
template <class Range, class Iterator>
constexpr void nth_element(Range&& range, Iterator nth) {
  std::nth_element(std::begin(range), nth, std::end(range));
}

}  // namespace ranges
}  // namespace std

#endif
