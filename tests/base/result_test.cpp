#include <nendo/base/result.hpp>

#include <memory>
#include <string>

#include <doctest/doctest.h>

namespace result_test {

using nendo::Errc;
using nendo::Error;
using nendo::Result;

namespace {

Result<std::unique_ptr<int>> halve(int n) {
  if (n % 2 != 0) return Error{Errc::bad_input, std::to_string(n) + " is odd"};
  return std::make_unique<int>(n / 2);
}

} // namespace

TEST_SUITE("result") {
  TEST_CASE("a result holds either the value or the error") {
    auto good = halve(8);
    REQUIRE(good);
    CHECK(**good == 4);
    const std::unique_ptr<int> moved = *std::move(good);
    CHECK(*moved == 4);

    const auto bad = halve(7);
    REQUIRE_FALSE(bad);
    CHECK(bad.error().code == Errc::bad_input);
    CHECK(bad.error().message == "7 is odd");
  }

  TEST_CASE("a result without a value is good unless it is made from an error") {
    CHECK(Result<void>{});
    const Result<void> bad = Error{Errc::no_permission, "no"};
    REQUIRE_FALSE(bad);
    CHECK(bad.error().code == Errc::no_permission);
  }
}

} // namespace result_test
