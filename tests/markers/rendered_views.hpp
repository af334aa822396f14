#pragma once
// Pictures of bracelets and sheets as a camera would take them, with blur and noise. Made from the
// measures of the bracelet and from the cells of its markers, not from the drawing or the tracker.

#include <array>
#include <cmath>
#include <cstddef>
#include <random>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include <nendo/base/side.hpp>

#include "markers/bracelet.hpp"
#include "markers/camera_model.hpp"
#include "markers/marker_detector.hpp"

namespace nendo::test {

inline constexpr double texture_px_per_m = 8000.0;

/// A picture of paper of this size, with markers whose upper left corners are given in metres.
struct Paper {
  cv::Mat picture;
  explicit Paper(double width_m, double height_m)
      : picture(static_cast<int>(height_m * texture_px_per_m),
                static_cast<int>(width_m * texture_px_per_m), CV_8U, cv::Scalar(235)) {}

  void add_marker(int number, double x_m, double y_m) {
    const double cell_px = markers::marker_side_m / 6 * texture_px_per_m; // 32
    const auto white = markers::marker_cells(number);
    for (int row = -1; row < 5; ++row)
      for (int column = -1; column < 5; ++column) {
        const bool inside = row >= 0 && row < 4 && column >= 0 && column < 4;
        if (inside && white[static_cast<std::size_t>(row)][static_cast<std::size_t>(column)])
          continue;
        const cv::Rect cell(static_cast<int>(x_m * texture_px_per_m + (column + 1) * cell_px),
                            static_cast<int>(y_m * texture_px_per_m + (row + 1) * cell_px),
                            static_cast<int>(cell_px), static_cast<int>(cell_px));
        cv::rectangle(picture, cell, cv::Scalar(25), cv::FILLED);
      }
  }
};

inline Paper plate_paper(Side side, int plate) {
  using namespace markers;
  Paper paper(plate_side_m, plate_side_m);
  for (int marker = 0; marker < markers_per_plate; ++marker)
    paper.add_marker(marker_number({side, plate, marker}),
                     margin_m + (marker % 2) * (marker_side_m + margin_m),
                     margin_m + (marker / 2) * (marker_side_m + margin_m));
  return paper;
}

/// A camera without distortion, and the picture that it is taking.
class RenderedView {
public:
  RenderedView(const markers::CameraModel& camera, std::mt19937& random)
      : camera_(camera), random_(random),
        canvas_(fine * camera.height_px, fine * camera.width_px, CV_8U, cv::Scalar(110)) {
    std::uniform_int_distribution<int> grey(40, 200);
    std::uniform_int_distribution<int> x(0, canvas_.cols);
    std::uniform_int_distribution<int> y(0, canvas_.rows);
    for (int clutter = 0; clutter < 40; ++clutter)
      cv::rectangle(canvas_, {x(random_), y(random_)}, {x(random_), y(random_)},
                    cv::Scalar(grey(random_)), cv::FILLED);
  }

  /// Draws paper whose upper left corner and edges are given in the camera's frame.
  void draw(const Paper& paper, const cv::Vec3d& corner_m, const cv::Vec3d& along_x,
            const cv::Vec3d& along_y) {
    const double width_m = paper.picture.cols / texture_px_per_m;
    const double height_m = paper.picture.rows / texture_px_per_m;
    const std::array<cv::Point2f, 4> there{
        pixel_of(corner_m), pixel_of(corner_m + width_m * along_x),
        pixel_of(corner_m + width_m * along_x + height_m * along_y),
        pixel_of(corner_m + height_m * along_y)};
    // A pixel's number is that of its centre.
    const auto right = static_cast<float>(paper.picture.cols) - 0.5F;
    const auto bottom = static_cast<float>(paper.picture.rows) - 0.5F;
    const std::array<cv::Point2f, 4> here{cv::Point2f(-0.5F, -0.5F), cv::Point2f(right, -0.5F),
                                          cv::Point2f(right, bottom), cv::Point2f(-0.5F, bottom)};
    cv::warpPerspective(paper.picture, canvas_,
                        cv::getPerspectiveTransform(here.data(), there.data()), canvas_.size(),
                        cv::INTER_LINEAR, cv::BORDER_TRANSPARENT);
  }

  /// Draws the plates that face the camera. `turn` and `place_m` are bracelet to camera.
  void draw_bracelet(Side side, const cv::Matx33d& turn, const cv::Vec3d& place_m) {
    using namespace markers;
    for (int plate = 0; plate < plates; ++plate) {
      // A hexagon's half: the plates meet at their edges, 57 mm from the axis.
      const double angle = (plate - 1) * CV_PI / 3;
      const double radius_m = plate_side_m * 0.8660254037844386;
      const cv::Vec3d out = turn * cv::Vec3d(std::sin(angle), 0, std::cos(angle));
      const cv::Vec3d along_x = turn * cv::Vec3d(std::cos(angle), 0, -std::sin(angle));
      const cv::Vec3d along_y = turn * cv::Vec3d(0, -1, 0);
      const cv::Vec3d centre_m = place_m + radius_m * out;
      if (centre_m.dot(out) >= 0) continue; // its back
      draw(plate_paper(side, plate), centre_m - plate_side_m / 2 * (along_x + along_y), along_x,
           along_y);
    }
  }

  cv::Mat taken(double blur_px = 0.7, double noise = 4.0) {
    cv::Mat picture;
    cv::resize(canvas_, picture, {camera_.width_px, camera_.height_px}, 0, 0, cv::INTER_AREA);
    cv::GaussianBlur(picture, picture, {}, blur_px);
    cv::Mat grain(picture.size(), CV_16S);
    cv::RNG numbers(random_());
    numbers.fill(grain, cv::RNG::NORMAL, 0.0, noise);
    cv::add(picture, grain, picture, cv::noArray(), CV_8U);
    return picture;
  }

private:
  static constexpr int fine = 3; ///< pixels of the canvas per pixel of the picture

  cv::Point2f pixel_of(const cv::Vec3d& place_m) const {
    const double u = camera_.focal_px[0] * place_m[0] / place_m[2] + camera_.centre_px[0];
    const double v = camera_.focal_px[1] * place_m[1] / place_m[2] + camera_.centre_px[1];
    return {static_cast<float>((u + 0.5) * fine - 0.5), static_cast<float>((v + 0.5) * fine - 0.5)};
  }

  markers::CameraModel camera_;
  std::mt19937& random_;
  cv::Mat canvas_;
};

/// The camera of the tests, 60 degrees wide, whose centre is not the picture's.
inline markers::CameraModel true_camera() {
  auto camera = markers::assumed_camera(1280, 720);
  camera.focal_px = {1112.0, 1108.0};
  camera.centre_px = {652.0, 351.0};
  return camera;
}

inline cv::Matx33d turn_about(const cv::Vec3d& axis, double angle_deg) {
  cv::Matx33d turn;
  cv::Rodrigues(axis * (angle_deg * CV_PI / 180 / cv::norm(axis)), turn);
  return turn;
}

/// A view of the sheet, tilted by up to 45 degrees in a random direction.
inline cv::Mat sheet_view(std::mt19937& random) {
  using namespace markers;
  std::uniform_real_distribution<double> unit(-1, 1);
  Paper paper(0.210, 0.205); // up to below the second strip
  for (int number = 0; number < 2 * markers_per_bracelet; ++number) {
    const auto corner = corners_on_sheet(*find_marker(number))[0];
    paper.add_marker(number, corner[0], corner[1]);
  }
  const cv::Matx33d turn = turn_about({0, 0, 1}, 20 * unit(random)) *
                           turn_about({unit(random), unit(random), 0}, 30 + 15 * unit(random));
  const cv::Vec3d middle_m(0.08 * unit(random), 0.04 * unit(random), 0.45 + 0.1 * unit(random));
  const cv::Vec3d along_x = turn * cv::Vec3d(1, 0, 0);
  const cv::Vec3d along_y = turn * cv::Vec3d(0, 1, 0);
  RenderedView view(true_camera(), random);
  view.draw(paper, middle_m - 0.105 * along_x - 0.1 * along_y, along_x, along_y);
  return view.taken();
}

} // namespace nendo::test
