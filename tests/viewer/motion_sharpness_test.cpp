#include "viewer/motion_sharpness.hpp"

#include <doctest/doctest.h>

#include <vector>

namespace motion_sharpness_test {

using nendo::viewer::MotionSharpness;

/// The parts of 200 pictures that take `fixed_ms` and, with all pixels, `pixels_ms` more.
std::vector<double> parts(double fixed_ms, double pixels_ms) {
  MotionSharpness sharpness;
  std::vector<double> drawn;
  for (int picture = 0; picture < 200; ++picture) {
    const double part = sharpness.part();
    drawn.push_back(part);
    sharpness.took(fixed_ms + pixels_ms * part * part);
  }
  return drawn;
}

TEST_SUITE("motion sharpness") {
  TEST_CASE("quick pictures have all pixels") {
    for (const double part : parts(20.0, 20.0))
      CHECK(part == 1.0);
  }

  TEST_CASE("slow pictures lose pixels until they are quick enough, and then stay as they are") {
    for (const double fixed_ms : {5.0, 20.0, 30.0})
      for (const double pixels_ms : {30.0, 50.0, 59.0}) {
        const std::vector<double> drawn = parts(fixed_ms, pixels_ms);
        const double last = drawn.back();
        CHECK(fixed_ms + pixels_ms * last * last < MotionSharpness::max_ms);
        for (std::size_t picture = 60; picture < drawn.size(); ++picture)
          CHECK(drawn[picture] == last);
      }
  }

  TEST_CASE("no picture has fewer than a quarter of the pixels") {
    CHECK(parts(100.0, 900.0).back() == 0.5);
  }

  TEST_CASE("pixels come back when the scene becomes simple") {
    MotionSharpness sharpness;
    for (int picture = 0; picture < 50; ++picture)
      sharpness.took(200.0);
    REQUIRE(sharpness.part() == 0.5);
    for (int picture = 0; picture < 50; ++picture)
      sharpness.took(8.0);
    CHECK(sharpness.part() == 1.0);
  }

  TEST_CASE("one picture that waited for another program changes nothing") {
    MotionSharpness sharpness;
    for (int picture = 0; picture < 50; ++picture)
      sharpness.took(picture == 20 ? 70.0 : 35.0);
    CHECK(sharpness.part() == 1.0);
  }
}

} // namespace motion_sharpness_test
