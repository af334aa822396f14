#include <cstdio>

#include <nendo/hand/inverse_kinematics.hpp>

#include "timeline/edit.hpp"
#include "timeline/edit_parts.hpp"

namespace nendo::timeline {

Result<TipSet> set_tip(Timeline& timeline, Side side, std::size_t key, hand::Finger finger,
                       const Eigen::Vector3d& target_m, double within_m) {
  auto track = track_with_key(timeline, side, key);
  if (!track) return track.error();
  if (!(target_m.cwiseAbs().maxCoeff() <= farthest_m) || !target_m.allFinite())
    return Error{Errc::usage, "the place must be within 1000 m of the stage's middle"};
  Key& edited = (*track)->keys[key];
  const hand::HandSkeleton skeleton = (*track)->skeleton();
  hand::FingertipTargets targets{};
  const auto number = static_cast<std::size_t>(finger);
  targets[number] = {target_m, 1.0};
  const hand::InverseSolution solution =
      hand::inverse_kinematics(skeleton, edited.wrist_pose(), targets, edited.angles);
  Key solved = edited;
  if (finger == hand::Finger::thumb) {
    solved.angles.thumb_roll_rad = solution.angles.thumb_roll_rad;
    solved.angles.thumb_abduction_rad = solution.angles.thumb_abduction_rad;
    solved.angles.thumb_mcp_flexion_rad = solution.angles.thumb_mcp_flexion_rad;
    solved.angles.thumb_ip_flexion_rad = solution.angles.thumb_ip_flexion_rad;
  } else {
    solved.angles[finger] = solution.angles[finger];
  }
  // Palm and wrist are as before, unless they were beyond their limits.
  const Eigen::Vector3d reached_m = skeleton.pose(solved.angles, solved.wrist_pose())
                                        .fingertip_positions()
                                        .col(static_cast<Eigen::Index>(number));
  const double off_m = (reached_m - target_m).norm();
  if (!(off_m <= within_m)) {
    char off[64];
    std::snprintf(off, sizeof off, "%.1f mm", 1e3 * off_m);
    return Error{Errc::usage, name_of_key(side, key) +
                                  ": out of reach; the nearest that the fingertip comes is " + off +
                                  " off, so choose a nearer place"};
  }
  if (const std::string wrong = complaint_about(solved); !wrong.empty())
    return Error{Errc::usage, name_of_key(side, key) + ": " + wrong};
  edited = solved;
  return TipSet{off_m};
}

} // namespace nendo::timeline
