// What a call is rejected with, and whether a text holds a part.
#pragma once

#include <exception>
#include <string>
#include <string_view>

inline const std::string not_rejected = "not rejected";

// The text of the error of this kind that the call throws.
template <class Error = std::exception, class Call>
std::string rejection_of(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return not_rejected;
}

inline bool contains(std::string_view text, std::string_view part) { return text.find(part) != text.npos; }
