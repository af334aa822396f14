#pragma once
// What a test cannot go on without.

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

} // namespace nendo::test
