#pragma once
// How a part moves that hands hold.

#include <span>

#include <Eigen/Geometry>

namespace nendo::deform {

/// A hand's frame when it took the part, or when somebody else did, and now.
struct HeldFrame {
  Eigen::Isometry3d from, now;
};

/// Returns the motion of what one hand or two hold. With two, it leads the middle between them to
/// the middle between them, and the line to the line; about the line it turns by the mean of what
/// the hands turn. If all frames are what they were, it is the identity, bit for bit. Wait-free.
Eigen::Isometry3d motion_of(std::span<const HeldFrame> hands) noexcept;

} // namespace nendo::deform
