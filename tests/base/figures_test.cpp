// Numbers and lists in messages.

#include <array>
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include <doctest/doctest.h>

#include <nendo/base/figures.hpp>

namespace figures_test {

using namespace nendo;

TEST_SUITE("figures") {
  TEST_CASE("a number has a comma after each three digits, and none after its sign") {
    CHECK(thousands(0) == "0");
    CHECK(thousands(999) == "999");
    CHECK(thousands(5000) == "5,000");
    CHECK(thousands(-999) == "-999");
    CHECK(thousands(-123456) == "-123,456");
    CHECK(thousands(std::numeric_limits<std::int64_t>::max()) == "9,223,372,036,854,775,807");
  }

  TEST_CASE("the last two of a list are divided by a word") {
    constexpr std::array<std::string_view, 3> names{"off", "mild", "strong"};
    CHECK(alternatives(names) == "off, mild or strong");
    CHECK(alternatives(std::span(names).first(2)) == "off or mild");
    CHECK(alternatives(std::span(names).first(1)) == "off");
    CHECK(alternatives({}).empty());
  }
}

} // namespace figures_test
