#pragma once
// The point that is at rest in a station's frame and in the tracker's, while the station turns
// about it: R_i centre + p_i = still for all poses i.

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace nendo::hand {

/// A pose of a station in the tracker's frame.
struct StationPose {
  double time_s = 0.0;
  Eigen::Matrix3d turn;
  Eigen::Vector3d position_m;
};

struct PivotFit {
  Eigen::Vector3d centre_m; ///< in the station's frame
  Eigen::Vector3d still_m;  ///< in the tracker's frame
  std::vector<StationPose> used;
  double residual_m = 0.0; ///< root mean square distance of R_i centre + p_i from `still_m`
  /// Singular values of the centre's equations after `still_m` was eliminated, per pose.
  double smallest_singular_value = 0.0;
  double largest_singular_value = 0.0;
  double centre_deviation_m = 0.0; ///< standard deviation of the centre's distance from the truth
  double drift_m = 0.0; ///< how far the point was from `still_m` for two seconds at worst
};

/// Fits the point by least squares to the poses that agree with most others. nullopt if no poses
/// determine it. The result depends on nothing else: its random choices are always the same.
std::optional<PivotFit> fit_pivot(const std::vector<StationPose>& poses);

} // namespace nendo::hand
