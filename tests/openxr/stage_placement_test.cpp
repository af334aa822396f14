// NENDO_XR_STAGE.

#include <clocale>
#include <cmath>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "openxr/stage_placement.hpp"

namespace openxr_stage_placement_test {

using namespace nendo::openxr;

TEST_SUITE("stage_placement") {
  TEST_CASE("three numbers are a position, and a fourth one a turn to the left") {
    StagePlacement placement;
    REQUIRE(read_placement("stage:1,-2.5,3e-1", placement));
    CHECK(placement.space == XR_REFERENCE_SPACE_TYPE_STAGE);
    CHECK(placement.pose.position.x == 1.0F);
    CHECK(placement.pose.position.y == -2.5F);
    CHECK(placement.pose.position.z == 0.3F);
    CHECK(placement.pose.orientation.w == 1.0F);
    REQUIRE(read_placement("local:0,0,0,90", placement));
    CHECK(placement.space == XR_REFERENCE_SPACE_TYPE_LOCAL);
    CHECK(placement.pose.orientation.y == doctest::Approx(std::sqrt(0.5)));
    CHECK(placement.pose.orientation.w == doctest::Approx(std::sqrt(0.5)));
  }

  TEST_CASE("everything else is refused, and changes nothing") {
    for (const char* const text : {"",
                                   "local",
                                   "local:",
                                   "local:1",
                                   "local:1,2",
                                   "local:1,2,",
                                   "local:1,2,3,",
                                   "local:1,2,3,4,",
                                   "local:1,2,3,4,5",
                                   "local:1;2;3",
                                   "local:a,b,c",
                                   "local:nan,0,0",
                                   "local:inf,0,0",
                                   "local:101,0,0",
                                   "local:0,0,0,361",
                                   "view:0,0,0",
                                   "LOCAL:0,0,0",
                                   "local:0,0,0 ",
                                   "stage:0,0,0x",
                                   "0,0,0"}) {
      CAPTURE(text);
      StagePlacement placement;
      CHECK_FALSE(read_placement(text, placement));
      CHECK(placement.pose.position.y == -0.4F);
      CHECK(placement.space == XR_REFERENCE_SPACE_TYPE_LOCAL);
    }
  }

  TEST_CASE("a decimal point is a point in each locale") {
    const std::string before = std::setlocale(LC_NUMERIC, nullptr);
    for (const char* const locale : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"}) {
      std::setlocale(LC_NUMERIC, locale); // stays as it is where the locale is not installed
      StagePlacement placement;
      CHECK(read_placement("local:0.5,0,0", placement));
      CHECK(placement.pose.position.x == 0.5F);
    }
    std::setlocale(LC_NUMERIC, before.c_str());
  }

  TEST_CASE("random text gives a unit quaternion and a position within 100 m, or nothing") {
    std::mt19937 random(7);
    const std::string characters = "0123456789.,-+e:nainflocstge ";
    int read = 0;
    for (int turn = 0; turn < 20'000; ++turn) {
      std::string text = random() % 2 == 0 ? "local:" : "stage:";
      if (random() % 2 == 0) text += std::to_string(random() % 200) + ",1,";
      for (std::size_t length = random() % 12; length > 0; --length)
        text += characters[random() % characters.size()];
      StagePlacement placement;
      if (!read_placement(text.c_str(), placement)) continue;
      ++read;
      const auto& q = placement.pose.orientation;
      CHECK(std::hypot(q.y, q.w) == doctest::Approx(1.0));
      CHECK(std::abs(placement.pose.position.x) <= 100.0F);
    }
    CHECK(read > 100);
  }
}

} // namespace openxr_stage_placement_test
