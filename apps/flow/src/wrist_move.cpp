#include <nendo/flow/wrist_move.hpp>

#include <algorithm>
#include <cmath>

namespace nendo::flow {
namespace {

// Far from where the square of a length is no longer a number.
constexpr double min_length = 1e-3;
constexpr double max_length = 1e3;

} // namespace

WristMove WristMove::to(Side side, const Eigen::Isometry3d& T_stage_wrist) noexcept {
  const Eigen::Vector3d& at = T_stage_wrist.translation();
  const Eigen::Quaterniond turn(T_stage_wrist.linear());
  return {side, {at.x(), at.y(), at.z()}, {turn.x(), turn.y(), turn.z(), turn.w()}};
}

bool WristMove::is_usable() const noexcept {
  const bool near = std::all_of(position_m.begin(), position_m.end(), [](double coordinate) {
    return std::abs(coordinate) <= farthest_m;
  });
  const double length = Eigen::Vector4d::Map(turn_xyzw.data()).norm();
  return near && length >= min_length && length <= max_length;
}

Eigen::Isometry3d WristMove::pose() const noexcept {
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.translation() = Eigen::Vector3d::Map(position_m.data());
  pose.linear() = Eigen::Quaterniond(turn_xyzw.data()).normalized().toRotationMatrix();
  return pose;
}

} // namespace nendo::flow
