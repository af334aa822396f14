#pragma once
// Violent strokes of a finger, of a rod, or of any body, that press a ball of clay.

#include <algorithm>
#include <random>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/contact_part.hpp>

#include "support/contact_parts.hpp"

namespace nendo::test {

using StrokeParts = std::vector<deform::ContactPart>;

/// Of the ball that the strokes are for, about the origin.
inline constexpr double stroked_ball_mm = 60.0;

// They begin outside of the ball, at the end of +z.
inline StrokeParts stroking_finger() {
  return {cone({0, 0, 71}, {0, 0, 130}, 8.0, 9.0)};
}
inline StrokeParts stroking_rod() {
  return {cone({-50, 0, 74}, {50, 0, 74}, 9.0, 9.0)};
}

inline Eigen::Vector3d random_direction(std::mt19937& random) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(random), normal(random), normal(random)).normalized();
}

/// At up to 1.5 m/s, 90 Hz: to the ball from any side, into it, on to any side, and away. Calls
/// begin(parts), and then press(parts) for each tick.
template <class Begin, class Press>
void violent_stroke(std::mt19937& random, StrokeParts parts, Begin&& begin, Press&& press) {
  const Eigen::Vector3d from = random_direction(random);
  parts = moved(
      parts, Eigen::Isometry3d(Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), from)));
  std::uniform_real_distribution<double> share(0.2, 1.0);
  const double speed = 16.7 * share(random);
  const Eigen::Vector3d in = -(10.0 + 30.0 * share(random)) * from;
  const Eigen::Vector3d aside = 40.0 * share(random) * from.cross(random_direction(random));
  const Eigen::Vector3d out = 60.0 * from;
  begin(parts);
  for (const Eigen::Vector3d& way : {in, aside, out}) {
    const int calls = std::max(1, static_cast<int>(way.norm() / speed));
    for (int call = 0; call < calls; ++call)
      press(parts = moved(parts, Eigen::Vector3d(way / calls)));
  }
  for (int wait = 0; wait < 20; ++wait)
    press(parts);
}

} // namespace nendo::test
