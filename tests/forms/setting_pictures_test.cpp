// The pictures of brushes and kernels.

#include <algorithm>
#include <cmath>
#include <string>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/flow/command.hpp>

#include "forms/setting_pictures.hpp"

namespace setting_pictures_test {

using namespace nendo;
using namespace nendo::forms;
using Eigen::Vector3d;

TEST_SUITE("setting_pictures") {
  TEST_CASE("the pictures of brushes are what brushes do") {
    struct Extent {
      double low = 0.0, high = 0.0, spread = 0.0;
    };
    const auto extent = [](deform::Brush brush) {
      Extent found;
      for (const auto& line : lines_of(brush))
        for (const Vector3d& at : line) {
          found.low = std::min(found.low, at.z());
          found.high = std::max(found.high, at.z());
          found.spread += at.head<2>().norm();
        }
      return found;
    };
    const Extent plain = extent(deform::Brush::none);
    CHECK(plain.high - plain.low == 0.0);
    CHECK(extent(deform::Brush::pull).high == doctest::Approx(0.6));
    CHECK(extent(deform::Brush::inflate).high > 0.3);
    CHECK(extent(deform::Brush::inflate).low > -0.05);
    CHECK(extent(deform::Brush::push).low < -0.3);
    CHECK(extent(deform::Brush::push).high < 0.05);
    CHECK(extent(deform::Brush::pinch).spread < 0.98 * plain.spread);
    CHECK(extent(deform::Brush::scale).spread > 1.02 * plain.spread);
    CHECK(std::abs(extent(deform::Brush::twist).spread / plain.spread - 1.0) < 0.02);
    for (const auto brush : {deform::Brush::smooth, deform::Brush::flatten}) { // and not far away
      const auto& row = lines_of(brush)[2];
      const auto height = [&](std::size_t from) {
        const auto [low, high] =
            std::minmax_element(row.begin() + static_cast<std::ptrdiff_t>(from),
                                row.begin() + static_cast<std::ptrdiff_t>(from + 9),
                                [](const auto& a, const auto& b) { return a.z() < b.z(); });
        return high->z() - low->z();
      };
      CHECK(height(20) < 0.6 * height(0));
    }
  }

  TEST_CASE(
      "each brush and each kernel has a picture within its square, and nothing else has one") {
    std::vector<std::string_view> names;
    for (std::size_t at = 0; at < deform::brush_count; ++at)
      names.push_back(name_of(static_cast<deform::Brush>(at)));
    for (const deform::Wendland kernel : flow::PendingSettings::kernels)
      names.push_back(name_of(kernel));
    for (const std::string_view name : names) {
      CAPTURE(name);
      const LinePicture* const picture = line_picture(name);
      REQUIRE(picture != nullptr);
      REQUIRE_FALSE(picture->empty());
      for (const auto& line : *picture) {
        CHECK(line.size() > 10);
        for (const Eigen::Vector2d& at : line) {
          CHECK((at.array() >= -0.01).all());
          CHECK((at.array() <= 1.01).all());
        }
      }
    }
    CHECK(line_picture("") == nullptr);
    CHECK(line_picture("none of them") == nullptr);
  }

  TEST_CASE("the page gets the same pictures as paths") {
    std::string text = line_pictures_js();
    text.erase(text.rfind(','), 1); // which JSON does not have
    const auto paths = nlohmann::json::parse(text);
    CHECK(paths.size() == deform::brush_count + flow::PendingSettings::kernels.size());
    const std::string kernel = paths["wendland-c2"];
    CHECK(kernel.starts_with("M0 100 2.5 ")); // nothing at the radius
    CHECK(kernel.find(" 50 0 ") != std::string::npos);
    CHECK(kernel.ends_with(" 100 100"));
    CHECK(text.size() < 40'000);
  }
}

} // namespace setting_pictures_test
