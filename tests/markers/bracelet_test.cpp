#include "markers/bracelet.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <regex>
#include <string>

#include <doctest/doctest.h>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "markers/marker_detector.hpp"
#include "markers/sheet.hpp"

namespace bracelet_test {

using namespace nendo;
using namespace nendo::markers;

namespace {

double distance(const Point3& a, const Point3& b) {
  return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (auto at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

/// Draws the boxes of an SVG, in their order, with two pixels per pixel of the SVG.
cv::Mat picture_of(const std::string& svg) {
  cv::Mat picture(2 * 1123, 2 * 794, CV_8U, cv::Scalar(255));
  const std::string number = "=\"([0-9.]+)\" ";
  const std::regex box("<rect x" + number + "y" + number + "width" + number + "height" + number +
                       "fill=\"#(0|f)");
  for (std::sregex_iterator at(svg.begin(), svg.end(), box); at != std::sregex_iterator(); ++at) {
    const auto edge = [&](std::size_t which) {
      return static_cast<int>(std::lround(2 * std::stod((*at)[which])));
    };
    const auto far_edge = [&](std::size_t which) {
      return static_cast<int>(
          std::lround(2 * (std::stod((*at)[which]) + std::stod((*at)[which + 2]))));
    };
    const cv::Rect pixels(cv::Point(edge(1), edge(2)), cv::Point(far_edge(1), far_edge(2)));
    cv::rectangle(picture, pixels, cv::Scalar((*at)[5] == "f" ? 255 : 0), cv::FILLED);
  }
  cv::GaussianBlur(picture, picture, {}, 1.0);
  return picture;
}

} // namespace

TEST_SUITE("bracelet") {
  TEST_CASE("the detector finds each marker of the sheet where it should be") {
    const auto markers = MarkerDetector().find(picture_of(draw_sheet()));
    CHECK(markers.size() == 2 * markers_per_bracelet);
    for (const Marker& marker : markers) {
      const auto place = find_marker(marker.number);
      REQUIRE(place);
      const auto corners = corners_on_sheet(*place);
      for (std::size_t corner = 0; corner < 4; ++corner)
        for (const std::size_t axis : {std::size_t{0}, std::size_t{1}}) {
          const double px = 2 * 96 * corners[corner][axis] / 0.0254 - 0.5;
          const double seen =
              static_cast<double>(axis == 0 ? marker.corners[corner].x : marker.corners[corner].y);
          CHECK(std::abs(seen - px) < 1.5);
        }
    }
  }

  TEST_CASE("each place has a number of its own, and each number its place") {
    for (int number = 0; number < 2 * markers_per_bracelet; ++number) {
      const auto place = find_marker(number);
      REQUIRE(place);
      CHECK(marker_number(*place) == number);
    }
    CHECK_FALSE(find_marker(-1));
    CHECK_FALSE(find_marker(2 * markers_per_bracelet));
  }

  TEST_CASE("markers are squares, as large on the bracelet as on the sheet") {
    for (int number = 0; number < 2 * markers_per_bracelet; ++number) {
      const auto place = *find_marker(number);
      const auto folded = corners_on_bracelet(place);
      const auto flat = corners_on_sheet(place);
      for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = 0; b < a; ++b) {
          const double side_m = (a - b) == 2 ? marker_side_m * std::sqrt(2.0) : marker_side_m;
          CHECK(std::abs(distance(folded[a], folded[b]) - side_m) < 1e-12);
          CHECK(std::abs(std::hypot(flat[a][0] - flat[b][0], flat[a][1] - flat[b][1]) - side_m) <
                1e-12);
        }
    }
  }

  TEST_CASE("a quarter of a marker's side around it is white") {
    for (int one = 0; one < 2 * markers_per_bracelet; ++one)
      for (int other = 0; other < one; ++other) {
        const auto a = corners_on_sheet(*find_marker(one))[0];
        const auto b = corners_on_sheet(*find_marker(other))[0];
        const double apart_m = std::max(std::abs(a[0] - b[0]), std::abs(a[1] - b[1]));
        CHECK(apart_m >= 1.25 * marker_side_m - 1e-12);
      }
  }

  TEST_CASE("plates are 60 degrees apart, and touch") {
    for (int plate = 0; plate + 1 < plates; ++plate) {
      const PlateFrame one = plate_frame(plate);
      const PlateFrame next = plate_frame(plate + 1);
      double cosine = 0.0;
      Point3 edge{};
      Point3 next_edge{};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        cosine += one.z_axis[axis] * next.z_axis[axis];
        edge[axis] = one.centre_m[axis] + plate_side_m / 2 * one.x_axis[axis];
        next_edge[axis] = next.centre_m[axis] - plate_side_m / 2 * next.x_axis[axis];
      }
      CHECK(std::abs(cosine - 0.5) < 1e-12);
      CHECK(distance(edge, next_edge) < 1e-12);
    }
  }

  TEST_CASE("the sheet is A4, with each marker, and a ruler of 100 mm") {
    const std::string svg = draw_sheet();
    // In SVG, an inch has 96 pixels.
    CHECK(svg.find("width=\"793.701\" height=\"1122.52\"") != std::string::npos);
    CHECK(count(svg, "width=\"90.71\" height=\"90.71\"") == 2 * markers_per_bracelet);
    CHECK(svg.find("x1=\"22.68\" y1=\"831.50\" x2=\"400.63\" y2=\"831.50\"") != std::string::npos);
    CHECK(count(svg, "stroke-dasharray=\"4 4\"") == 4);
    std::size_t runs = 0;
    for (int number = 0; number < 2 * markers_per_bracelet; ++number)
      for (const auto& row : marker_cells(number))
        for (std::size_t at = 0; at < row.size(); ++at)
          if (row[at] && (at == 0 || !row[at - 1])) ++runs;
    CHECK(count(svg, "fill=\"#ffffff\" fill-opacity") == runs);
  }
}

} // namespace bracelet_test
