#pragma once
// Control points all over a hand, with which the whole hand holds a model: on the bones of fingers
// and palm, scaled to the wearer, at least 12 mm apart in an open hand of average size.

#include <array>
#include <cstddef>

#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

struct HeldPoint {
  Joint from = Joint::wrist;
  Joint to = Joint::wrist;
  double share = 0.0;     ///< 0 at `from`, 1 at `to`
  std::size_t finger = 0; ///< 0 to 4, thumb to little; in the palm, by metacarpal
};

inline constexpr std::size_t held_point_count = 45;

/// Thumb to little finger, each from root to tip; the wrist is last.
inline constexpr std::array<HeldPoint, held_point_count> held_points = [] {
  std::array<HeldPoint, held_point_count> points{};
  std::size_t count = 0;
  const auto add = [&](std::size_t finger, std::size_t from, std::size_t parts, std::size_t first) {
    // The next joint in OpenXR's order ends the bone.
    for (std::size_t part = first; part < parts; ++part)
      points[count++] = {static_cast<Joint>(from), static_cast<Joint>(from + 1),
                         static_cast<double>(part) / static_cast<double>(parts), finger};
  };
  const auto end = [&](std::size_t finger) {
    points[count++] = {fingertips[finger], fingertips[finger], 0.0, finger};
  };
  const std::size_t thumb = index_of(Joint::thumb_metacarpal);
  add(0, thumb, 3, 0);
  add(0, thumb + 1, 2, 0);
  add(0, thumb + 2, 1, 0);
  end(0);
  for (std::size_t finger = 1; finger < finger_count; ++finger) {
    const std::size_t root = index_of(fingertips[finger]) - 4;
    add(finger, root, finger == 2 ? 4 : 3, 1); // the metacarpals begin side by side
    add(finger, root + 1, 3, 0);
    add(finger, root + 2, 2, 0);
    add(finger, root + 3, 1, 0);
    end(finger);
  }
  points[count] = {Joint::wrist, Joint::wrist, 0.0, 2};
  return points;
}();

using HeldPlaces = Eigen::Matrix<double, 3, static_cast<int>(held_point_count)>;

/// Returns the positions, 3 by 45; metres. Wait-free, no allocation.
inline HeldPlaces held_places(const HandPose& pose) noexcept {
  HeldPlaces places;
  for (std::size_t at = 0; at < held_point_count; ++at) {
    const HeldPoint& point = held_points[at];
    places.col(static_cast<Eigen::Index>(at)) =
        (1.0 - point.share) * pose[point.from].translation() +
        point.share * pose[point.to].translation();
  }
  return places;
}

} // namespace nendo::hand
