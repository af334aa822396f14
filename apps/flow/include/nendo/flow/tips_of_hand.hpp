#pragma once
// Where the points of a hand are by which it holds a model: five fingertips, or all over it.

#include <nendo/deform/mesh.hpp>
#include <nendo/hand/held_points.hpp>

namespace nendo::flow {

/// Writes `count` points of the hand, in model units, from that column on: 5, or
/// hand::held_point_count. Wait-free, no allocation.
inline void write_tips(const hand::HandPose& pose, double units_per_metre, Eigen::Index count,
                       Eigen::Index column, deform::Points& tips) noexcept {
  if (count == 5)
    tips.middleCols<5>(column) = units_per_metre * pose.fingertip_positions();
  else
    tips.middleCols<static_cast<int>(hand::held_point_count)>(column) =
        units_per_metre * hand::held_places(pose);
}

} // namespace nendo::flow
