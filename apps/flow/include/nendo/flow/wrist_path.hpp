#pragma once
// Where a simulated hand's wrist is at each time: no glove measures that.

#include <cstddef>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/api.hpp>

namespace nendo::flow {

class NENDO_API WristPath {
public:
  /// Poses on the stage, evenly in time, at least two.
  WristPath(std::vector<Eigen::Isometry3d> poses, double step_s);

  /// A time between two poses: `part` of the way from `first` to the next one, 0 to 1.
  struct Place {
    std::size_t first = 0;
    double part = 0.0;
  };
  /// Returns where a time since the beginning lies: before it at the first pose, after the end at
  /// the last one. A time that is not finite counts as 0. Thread-safe, wait-free.
  Place place(double time_s) const noexcept;
  /// Returns the pose at that time. Between two poses it is a line and the shortest turn.
  /// Thread-safe, wait-free.
  Eigen::Isometry3d at(double time_s) const noexcept;
  double length_s() const noexcept { return step_s_ * static_cast<double>(poses_.size() - 1); }

private:
  std::vector<Eigen::Isometry3d> poses_;
  double step_s_;
};

/// Returns the pose that is `part` of the way from one pose to another: 0 is `from`, and 1 is `to`.
NENDO_API Eigen::Isometry3d blended(const Eigen::Isometry3d& from, const Eigen::Isometry3d& to,
                                    double part) noexcept;

} // namespace nendo::flow
