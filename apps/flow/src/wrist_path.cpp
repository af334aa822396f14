#include <nendo/flow/wrist_path.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace nendo::flow {

using Eigen::Isometry3d;

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

} // namespace nendo::flow
