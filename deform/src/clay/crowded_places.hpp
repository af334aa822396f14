#pragma once
// Places of which none is to crowd another.

#include <array>
#include <cstddef>
#include <vector>

#include <Eigen/Core>

namespace nendo::deform {

class CrowdedPlaces {
public:
  /// Allocates for so many places; nothing else does.
  explicit CrowdedPlaces(std::size_t most);

  void clear() noexcept;
  /// Adds a place, unless one is nearer than the root of `squared` whose normal is within 60
  /// degrees of its normal. Returns whether it did. There must be room.
  bool add(const Eigen::Vector3f& at, const Eigen::Vector3f& normal, float squared) noexcept;

private:
  std::size_t count_ = 0;
  std::array<std::vector<float>, 6> rows_; ///< places and normals; beyond the last, far away
};

} // namespace nendo::deform
