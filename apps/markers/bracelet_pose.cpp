#include "markers/bracelet_pose.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <opencv2/calib3d.hpp>
#include <opencv2/core/quaternion.hpp>

#include "markers/bracelet.hpp"

namespace nendo::markers {
namespace {

/// Corners that are seen, and where they are.
struct Corners {
  std::vector<cv::Point3d> places_m;
  std::vector<cv::Point2d> pixels;
};

struct SeenBracelet {
  Corners all;                      ///< in the frame of the bracelet
  std::array<Corners, plates> flat; ///< in the frames of the plates
  int markers = 0;
};

SeenBracelet gather(Side side, std::span<const Marker> markers) {
  SeenBracelet seen;
  std::array<bool, markers_per_bracelet> has{};
  for (const Marker& marker : markers) {
    const auto place = find_marker(marker.number);
    if (!place || place->side != side) continue;
    bool& known = has[static_cast<std::size_t>(marker.number % markers_per_bracelet)];
    if (known) continue; // a reflection, or another sheet
    known = true;
    ++seen.markers;
    Corners& flat = seen.flat[static_cast<std::size_t>(place->plate)];
    const auto on_plate = corners_on_plate(place->marker);
    const auto on_bracelet = corners_on_bracelet(*place);
    for (std::size_t corner = 0; corner < 4; ++corner) {
      const cv::Point2d pixel(marker.corners[corner]);
      const auto& [x, y, z] = on_bracelet[corner];
      seen.all.places_m.emplace_back(x, y, z);
      seen.all.pixels.push_back(pixel);
      flat.places_m.emplace_back(on_plate[corner][0], on_plate[corner][1], 0.0);
      flat.pixels.push_back(pixel);
    }
  }
  return seen;
}

cv::Vec3d vector_of(const Point3& point) {
  return {point[0], point[1], point[2]};
}

/// The turn from a plate's frame to the bracelet's.
cv::Matx33d turn_of(const PlateFrame& frame) {
  cv::Matx33d turn;
  for (int row = 0; row < 3; ++row) {
    const auto at = static_cast<std::size_t>(row);
    turn(row, 0) = frame.x_axis[at];
    turn(row, 1) = frame.y_axis[at];
    turn(row, 2) = frame.z_axis[at];
  }
  return turn;
}

/// Returns whether the camera is in front of each plate of which it sees markers.
bool faces_camera(const SeenBracelet& seen, const BraceletPose& pose) {
  for (int plate = 0; plate < plates; ++plate) {
    if (seen.flat[static_cast<std::size_t>(plate)].pixels.empty()) continue;
    const PlateFrame frame = plate_frame(plate);
    const cv::Vec3d centre = pose.turn * vector_of(frame.centre_m) + pose.position_m;
    if (centre.dot(pose.turn * vector_of(frame.z_axis)) >= 0.0) return false;
  }
  return true;
}

/// Starts at the pose of one plate, and fits all corners.
BraceletPose refined(const SeenBracelet& seen, const CameraModel& camera, int plate,
                     const cv::Vec3d& plate_turn, const cv::Vec3d& plate_place_m) {
  const PlateFrame frame = plate_frame(plate);
  BraceletPose pose;
  cv::Matx33d turn;
  cv::Rodrigues(plate_turn, turn);
  pose.turn = turn * turn_of(frame).t();
  pose.position_m = plate_place_m - pose.turn * vector_of(frame.centre_m);
  cv::Vec3d rotation;
  cv::Rodrigues(pose.turn, rotation);
  cv::solvePnPRefineLM(seen.all.places_m, seen.all.pixels, camera.matrix(), camera.distortion,
                       rotation, pose.position_m);
  cv::Rodrigues(rotation, pose.turn);
  std::vector<cv::Point2d> pixels;
  cv::projectPoints(seen.all.places_m, rotation, pose.position_m, camera.matrix(),
                    camera.distortion, pixels);
  double squares = 0.0;
  for (std::size_t at = 0; at < pixels.size(); ++at) {
    const cv::Point2d off = pixels[at] - seen.all.pixels[at];
    squares += off.dot(off);
  }
  pose.error_px = std::sqrt(squares / static_cast<double>(pixels.size()));
  pose.markers = seen.markers;
  return pose;
}

std::vector<BraceletPose> possible_poses(const SeenBracelet& seen, const CameraModel& camera) {
  std::vector<BraceletPose> poses;
  for (int plate = 0; plate < plates; ++plate) {
    const Corners& flat = seen.flat[static_cast<std::size_t>(plate)];
    if (flat.pixels.empty()) continue;
    std::vector<cv::Vec3d> turns;
    std::vector<cv::Vec3d> places;
    cv::solvePnPGeneric(flat.places_m, flat.pixels, camera.matrix(), camera.distortion, turns,
                        places, false, cv::SOLVEPNP_IPPE);
    for (std::size_t at = 0; at < turns.size(); ++at) {
      const BraceletPose pose = refined(seen, camera, plate, turns[at], places[at]);
      if (pose.error_px <= max_error_px && pose.position_m[2] > 0.0 && faces_camera(seen, pose))
        poses.push_back(pose);
    }
  }
  return poses;
}

/// The cosine of half the angle would do as well: it only compares.
double alike(const BraceletPose& one, const BraceletPose& other) {
  return cv::trace(one.turn.t() * other.turn);
}

} // namespace

std::optional<BraceletPose> find_bracelet(Side side, std::span<const Marker> markers,
                                          const CameraModel& camera,
                                          const std::optional<BraceletPose>& previous) {
  const SeenBracelet seen = gather(side, markers);
  if (seen.markers < min_markers) return std::nullopt;
  const auto poses = possible_poses(seen, camera);
  if (poses.empty()) return std::nullopt;
  BraceletPose best =
      *std::min_element(poses.begin(), poses.end(), [](const auto& one, const auto& other) {
        return one.error_px < other.error_px;
      });
  if (!previous) return best;
  constexpr double about_equally = 1.5;
  const double limit_px = best.error_px * about_equally;
  for (const BraceletPose& pose : poses)
    if (pose.error_px <= limit_px && alike(pose, *previous) > alike(best, *previous)) best = pose;
  return best;
}

StagePose to_stage(const BraceletPose& pose) {
  const cv::Matx33d stage_from_camera(-1, 0, 0, 0, -1, 0, 0, 0, 1);
  const cv::Vec3d position = stage_from_camera * pose.position_m;
  const auto q = cv::Quatd::createFromRotMat(cv::Mat(stage_from_camera * pose.turn)).normalize();
  return {{position[0], position[1], position[2]}, {q.x, q.y, q.z, q.w}};
}

} // namespace nendo::markers
