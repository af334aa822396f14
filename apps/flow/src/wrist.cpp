// The position of a wrist, and the switch at it.

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include <nendo/flow/wrist.hpp>

namespace nendo::flow {

using Eigen::Isometry3d;

namespace {

// Far from where the square of a length is no longer a number.
constexpr double min_length = 1e-3;
constexpr double max_length = 1e3;

constexpr std::array<std::string_view, 5> action_names{"none", "grab", "commit", "toggle", "keep"};

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

WristPath::WristPath(std::vector<Isometry3d> poses, double step_s)
    : poses_(std::move(poses)), step_s_(step_s) {}

WristPath::Place WristPath::place(double time_s) const noexcept {
  const double last = static_cast<double>(poses_.size() - 1);
  const double at = time_s > 0.0 && std::isfinite(time_s) ? std::min(time_s / step_s_, last) : 0.0;
  const double whole = std::min(std::floor(at), last - 1.0);
  return {static_cast<std::size_t>(whole), at - whole};
}

Isometry3d WristPath::at(double time_s) const noexcept {
  const auto [first, part] = place(time_s);
  return blended(poses_[first], poses_[first + 1], part);
}

Isometry3d blended(const Isometry3d& from, const Isometry3d& to, double part) noexcept {
  const Eigen::Quaterniond before(from.linear());
  const Eigen::Quaterniond after(to.linear());
  Isometry3d pose = Isometry3d::Identity();
  pose.linear() = before.slerp(part, after).toRotationMatrix();
  pose.translation() = from.translation() + part * (to.translation() - from.translation());
  return pose;
}

std::string_view name_of(SwitchAction action) noexcept {
  return action_names[static_cast<std::size_t>(action)];
}

std::optional<SwitchAction> switch_action_named(std::string_view name) noexcept {
  for (std::size_t at = 0; at < action_names.size(); ++at) {
    if (action_names[at] == name) return static_cast<SwitchAction>(at);
  }
  return std::nullopt;
}

bool WristSwitchEdge::turned_on(WristSwitch position, HostTime time) noexcept {
  if (position == WristSwitch::unknown) return false;
  if (settled_ == WristSwitch::unknown) settled_ = position;
  if (position == settled_) {
    differs_since_.reset();
    return false;
  }
  if (!differs_since_) {
    differs_since_ = time;
    return false;
  }
  if (time - *differs_since_ < settling_time) return false;
  settled_ = position;
  differs_since_.reset();
  return is_on();
}

} // namespace nendo::flow
