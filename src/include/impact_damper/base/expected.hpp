// The result of a step that can fail, or the reason why there is none.
#pragma once

#include <utility>
#include <variant>

namespace impact_damper {

// The caller must check first whether there is a result: reading one that is not there throws
// std::bad_variant_access, as does asking for a failure that did not happen.
template <class Value, class Failure>
class Expected {
 public:
  // NOLINTNEXTLINE(google-explicit-constructor)
  Expected(Value value) : content_(std::move(value)) {}  // cppcheck-suppress noExplicitConstructor
  // NOLINTNEXTLINE(google-explicit-constructor)
  Expected(Failure failure) : content_(std::move(failure)) {}  // cppcheck-suppress noExplicitConstructor

  explicit operator bool() const { return std::holds_alternative<Value>(content_); }
  const Value& operator*() const& { return std::get<Value>(content_); }
  Value& operator*() & { return std::get<Value>(content_); }
  Value&& operator*() && { return std::get<Value>(std::move(content_)); }
  const Value* operator->() const { return &**this; }
  Value* operator->() { return &**this; }
  const Failure& failure() const { return std::get<Failure>(content_); }

 private:
  std::variant<Value, Failure> content_;
};

}  // namespace impact_damper
