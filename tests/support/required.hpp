#pragma once
// What a test cannot continue without.

#include <utility>

#include <doctest/doctest.h>

#include <nendo/base/result.hpp>

namespace nendo::test {

/// Returns the value of a result. An error ends the test, with its message.
template <class Value>
Value required(Result<Value> result) {
  REQUIRE_MESSAGE(result, result.error().message);
  return *std::move(result);
}

/// Ends the test where a result is an error, with its message.
inline void require_ok(const Result<void>& result) {
  REQUIRE_MESSAGE(result, result.error().message);
}

} // namespace nendo::test
