#pragma once
// Random edits of a puppet.

#include <array>
#include <memory>

#include <nendo/puppet/puppet_edit.hpp>

#include "support/flow_fixtures.hpp"

namespace nendo::test {

inline std::shared_ptr<const puppet::Rig> rig_of(const puppet::Puppet& puppet,
                                                 const deform::Mesh& model) {
  return std::make_shared<const puppet::Rig>(puppet, model);
}

/// Returns the puppet after an edit; the same one, if the edit is refused, or if it would have more
/// points than `max_points`. Without a puppet, it is that of the ball.
template <class Random>
std::shared_ptr<const puppet::Rig> any_puppet(const std::shared_ptr<const puppet::Rig>& now,
                                              const deform::Mesh& model, Random& random,
                                              std::size_t max_points = 10) {
  if (!now) return rig_of(*puppet::parse_puppet(ball_puppet, "a test's puppet"), model);
  const auto number = [&](double min, double max) {
    return min + (max - min) * static_cast<double>(random() % 1000) / 1000.0;
  };
  const auto vector = [&](double size) {
    const double x = number(-size, size), y = number(-size, size);
    return Eigen::Vector3d(x, y, number(-size, size));
  };
  const std::size_t point = random() % now->puppet().points.size();
  const std::size_t function = random() % now->puppet().functions.size();
  const auto finger = *puppet::HandSignal::numbered(random() % 2 == 0 ? Side::left : Side::right,
                                                    static_cast<std::uint8_t>(random() % 5));
  const Eigen::Vector3d place = vector(1.0).normalized();
  const std::array strokes{place};
  const auto edited = [&]() -> Result<puppet::Puppet> {
    switch (random() % 9) {
    case 0:
      return puppet::with_radius(*now, point, number(0.4, 0.9));
    case 1:
      return puppet::with_input(*now, function, finger, number(0.3, 0.9));
    case 2:
      return puppet::with_function(*now, {place, number(0.4, 0.9)}, vector(0.2), finger, 0.6);
    case 3:
      return puppet::with_pin(*now, {place, number(0.3, 0.6)});
    case 4:
      return puppet::without_point(*now, point);
    case 5:
      return puppet::with_mirror(*now, !now->puppet().mirrors);
    case 6:
      return puppet::with_masks(*now, strokes, number(0.1, 0.4));
    case 7:
      return puppet::with_name(*now, function, "name" + std::to_string(random() % 9));
    default:
      return puppet::with_move(*now, function, point, vector(0.2));
    }
  }();
  return edited && edited->points.size() <= max_points ? rig_of(*edited, model) : now;
}

/// Returns other masks of fingertips, or the same ones mirrored; null is none.
template <class Random>
std::shared_ptr<const puppet::Rig> any_masks(const std::shared_ptr<const puppet::Rig>& now,
                                             Random& random) {
  const deform::Points no_points(3, 0);
  const puppet::Rig before(now ? now->puppet() : puppet::Puppet{}, no_points);
  Eigen::Vector3d place;
  for (double& coordinate : place)
    coordinate = static_cast<double>(random() % 2001) / 1000.0 - 1.0;
  const std::array strokes{Eigen::Vector3d(place.stableNormalized())};
  const double radius = 0.2 + 0.01 * static_cast<double>(random() % 60);
  const bool is_on = !before.puppet().mirrors;
  const auto edited = [&]() -> Result<puppet::Puppet> {
    switch (random() % 7) {
    case 0:
    case 1:
      return puppet::with_masks(before, strokes, radius);
    case 2:
      return puppet::without_masks(before, strokes, radius);
    case 3:
      return puppet::without_any_mask(before);
    case 4:
      return puppet::with_masks_inverted(before);
    default:
      return puppet::with_symmetry(before, is_on, 0.0);
    }
  }();
  if (!edited || *edited == before.puppet()) return now;
  return std::make_shared<const puppet::Rig>(*edited, no_points);
}

} // namespace nendo::test
