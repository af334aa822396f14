#include <nendo/version.hpp>

#include <string>

#include <doctest/doctest.h>

namespace version_test {

TEST_SUITE("version") {
  TEST_CASE("the numbers are those of the text") {
    CHECK(std::to_string(NENDO_VERSION_MAJOR) + "." + std::to_string(NENDO_VERSION_MINOR) + "." +
              std::to_string(NENDO_VERSION_PATCH) ==
          NENDO_VERSION);
  }
}

} // namespace version_test
