// The enumerators of an enumeration and their names, as used in files and options. The enumerators count from
// 0.
#pragma once

#include <array>
#include <cstddef>
#include <initializer_list>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace impact_damper {

template <class Type>
concept Enumeration = std::is_enum_v<Type>;

namespace detail {

// The name of the enumerator with this value; "" where there is none: the compiler then shows a number after
// a cast.
template <auto value>
consteval std::string_view enumerator() {
  std::string_view text = __PRETTY_FUNCTION__;  // "... value = impact_damper::Wall::left]", or ";" after it
  constexpr std::string_view before = "value = ";
  text.remove_prefix(text.find(before) + before.size());
  text = text.substr(0, text.find_first_of(";]"));
  text.remove_prefix(text.rfind(':') + 1);
  return text.find(')') == std::string_view::npos ? text : "";
}

// The enumerator's name with a zero behind it, for C.
template <auto value>
inline constexpr auto with_zero = [] {
  std::array<char, enumerator<value>().size() + 1> text{};
  enumerator<value>().copy(text.data(), text.size() - 1);
  return text;
}();

template <class Enum, std::size_t from = 0>
consteval std::size_t count_of() {
  if constexpr (enumerator<static_cast<Enum>(from)>().empty())
    return from;
  else
    return count_of<Enum, from + 1>();
}

template <class Enum>
using IndicesOf = std::make_index_sequence<count_of<Enum>()>;

template <class Enum, class Indices = IndicesOf<Enum>>
inline constexpr std::array<std::string_view, 0> names{};
template <class Enum, std::size_t... i>
inline constexpr std::array<std::string_view, sizeof...(i)> names<Enum, std::index_sequence<i...>>{
    with_zero<static_cast<Enum>(i)>.data()...};

}  // namespace detail

// All enumerators, in their order.
template <class Enum, class Indices = detail::IndicesOf<Enum>>
inline constexpr std::initializer_list<Enum> all_of{};
template <class Enum, std::size_t... i>
inline constexpr std::initializer_list<Enum> all_of<Enum, std::index_sequence<i...>>{static_cast<Enum>(i)...};

// Returns the enumerator's own name; its data() ends with a zero, for C. An enumeration with other words has
// a name_of of its own.
template <Enumeration Enum>
constexpr std::string_view name_of(Enum value) {
  return detail::names<Enum>.at(static_cast<std::size_t>(value));
}

template <Enumeration Enum>
std::vector<std::string_view> words_of(std::initializer_list<Enum> values = all_of<Enum>) {
  std::vector<std::string_view> words;
  words.reserve(values.size());
  for (const Enum value : values) words.push_back(name_of(value));
  return words;
}

}  // namespace impact_damper
