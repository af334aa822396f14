#include "markers/camera_model.hpp"

#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "support/required.hpp"

namespace camera_model_test {

using namespace nendo;
using namespace nendo::markers;

TEST_SUITE("camera_model") {
  TEST_CASE("a calibration reads as it was written") {
    CameraModel camera = assumed_camera(1280, 720);
    camera.distortion = {0.1, -0.2, 1e-4, -2e-5, 0};
    camera.error_px = 0.31;
    const CameraModel back = test::required(camera_from_toml(to_toml(camera), "camera.toml"));
    CHECK(back.width_px == 1280);
    CHECK(back.height_px == 720);
    CHECK(back.focal_px == camera.focal_px);
    CHECK(back.centre_px == camera.centre_px);
    CHECK(back.distortion == camera.distortion);
    CHECK(back.error_px == camera.error_px);
  }

  TEST_CASE("a file that is no calibration of a camera is an error that names the line") {
    const std::string good = to_toml(assumed_camera(1280, 720));
    struct Case {
      std::string from;
      std::string to;
      std::string said;
    };
    for (const Case& wrong :
         {Case{"width_px = 1280", "width_px = 0", "width_px"},
          Case{"width_px = 1280", "", "width_px"},
          Case{"height_px = 720", "height_px = 1e9", "height_px"},
          Case{"focal_px = [", "focal_px = [0.0, ", "focal_px"},
          Case{"focal_px = [1", "focal_px = [-1", "focal_px"},
          Case{"centre_px = [", "centre_px = [1e300, ", "centre_px"},
          Case{"distortion = [0.0", "distortion = [inf", "camera.toml:7"},
          Case{"distortion = [0.0", "distortion = [1e9", "lens"},
          Case{"version = 1", "version = 2", "version"}, Case{"error_px", "eror_px", "eror_px"}}) {
      CAPTURE(wrong.to);
      std::string text = good;
      text.replace(text.find(wrong.from), wrong.from.size(), wrong.to);
      const auto camera = camera_from_toml(text, "camera.toml");
      REQUIRE_FALSE(camera);
      CAPTURE(camera.error().message);
      CHECK(camera.error().code == Errc::bad_input);
      CHECK(camera.error().message.find("camera.toml:") == 0);
      CHECK(camera.error().message.find(wrong.said) != std::string::npos);
    }
  }

  TEST_CASE("a calibration holds for pictures of the same shape, and no others") {
    const CameraModel camera = assumed_camera(1280, 720);
    const CameraModel half = test::required(scaled_to(camera, 640, 360));
    CHECK(std::abs(half.focal_px[0] - camera.focal_px[0] / 2) < 1e-9);
    CHECK(std::abs(half.centre_px[0] - 319.5) < 1e-9);
    CHECK(scaled_to(camera, 640, 480).error().message.find("640 x 480") != std::string::npos);
  }
}

} // namespace camera_model_test
