#include "markers/sheet_calibration.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include <opencv2/calib3d.hpp>

#include "markers/bracelet.hpp"

namespace nendo::markers {
namespace {

constexpr std::size_t min_markers_in_view = 8;
constexpr std::size_t min_views = 8;
constexpr double max_still_px = 2.0;
/// The part of the picture's width by which a view must differ from the previous one.
constexpr double min_difference = 0.04;
constexpr double max_calibration_error_px = 1.0;
constexpr double max_focal_deviation = 0.01; ///< relative; more is too little tilt

} // namespace

SheetCalibration::View SheetCalibration::view_of(std::span<const Marker> markers) {
  View view;
  for (const Marker& marker : markers) {
    const auto place = find_marker(marker.number);
    const auto begin = view.numbers.begin();
    if (!place || std::find(begin, view.numbers.end(), marker.number) != view.numbers.end())
      continue;
    view.numbers.push_back(marker.number);
    const auto on_sheet = corners_on_sheet(*place);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      view.places_m.emplace_back(static_cast<float>(on_sheet[corner][0]),
                                 static_cast<float>(on_sheet[corner][1]), 0.0F);
      view.pixels.push_back(marker.corners[corner]);
    }
  }
  return view;
}

/// The mean distance of the markers' first corners that both views have.
double SheetCalibration::distance_px(const View& one, const View& other) {
  double sum_px = 0.0;
  int count = 0;
  for (std::size_t at = 0; at < one.numbers.size(); ++at) {
    const auto found = std::find(other.numbers.begin(), other.numbers.end(), one.numbers[at]);
    if (found == other.numbers.end()) continue;
    const auto there = static_cast<std::size_t>(found - other.numbers.begin());
    sum_px += cv::norm(one.pixels[4 * at] - other.pixels[4 * there]);
    ++count;
  }
  return count > 0 ? sum_px / count : std::numeric_limits<double>::infinity();
}

bool SheetCalibration::offer(std::span<const Marker> markers) {
  const View before = std::exchange(previous_picture_, view_of(markers));
  const bool is_still = distance_px(previous_picture_, before) <= max_still_px;
  const bool is_other =
      views_.empty() || distance_px(previous_picture_, views_.back()) >= min_difference * width_px_;
  return is_still && is_other && add_view(markers);
}

bool SheetCalibration::add_view(std::span<const Marker> markers) {
  View view = view_of(markers);
  if (view.numbers.size() < min_markers_in_view) return false;
  views_.push_back(std::move(view));
  return true;
}

Result<CameraModel> SheetCalibration::solve() const {
  if (views_.size() < min_views)
    return Error{Errc::failed, "the sheet was seen still in " + std::to_string(views_.size()) +
                                   " views; show it in at least " + std::to_string(min_views)};
  std::vector<std::vector<cv::Point3f>> places_m;
  std::vector<std::vector<cv::Point2f>> pixels;
  for (const View& view : views_) {
    places_m.push_back(view.places_m);
    pixels.push_back(view.pixels);
  }
  CameraModel camera = assumed_camera(width_px_, height_px_);
  cv::Mat matrix(camera.matrix());
  cv::Mat distortion;
  cv::Mat deviations;
  cv::Mat unused;
  std::vector<cv::Mat> turns;
  std::vector<cv::Mat> shifts;
  // k3 needs more of the picture's corners than a sheet reaches.
  camera.error_px = cv::calibrateCamera(places_m, pixels, cv::Size(width_px_, height_px_), matrix,
                                        distortion, turns, shifts, deviations, unused, unused,
                                        cv::CALIB_USE_INTRINSIC_GUESS | cv::CALIB_FIX_K3);
  camera.focal_px = {matrix.at<double>(0, 0), matrix.at<double>(1, 1)};
  camera.centre_px = {matrix.at<double>(0, 2), matrix.at<double>(1, 2)};
  for (std::size_t at = 0; at < camera.distortion.size(); ++at)
    camera.distortion[at] = distortion.at<double>(static_cast<int>(at));
  if (!(camera.error_px <= max_calibration_error_px))
    return Error{Errc::failed, "the views do not fit together; fix the sheet on something flat, "
                               "and hold it still"};
  if (!(deviations.at<double>(0) <= max_focal_deviation * camera.focal_px[0]))
    return Error{Errc::failed, "the focal length stays uncertain; tilt the sheet more, by 20 to 45 "
                               "degrees in each direction"};
  return camera;
}

} // namespace nendo::markers
