#include "render/coarse_surface.hpp"

#include <algorithm>
#include <limits>

namespace nendo::render {

using Eigen::Vector3f;

namespace {

constexpr std::size_t dense_places = 250'000; // below, all triangles are cast within a second
constexpr float far_place_m = 1e6F;
constexpr std::uint32_t no_cube = std::numeric_limits<std::uint32_t>::max();

/// The cubes of a grid that have places, numbered as they come.
class Cubes {
public:
  Cubes(const std::vector<Vector3f>& places, int along)
      : along_(along), numbers_(static_cast<std::size_t>(along) * static_cast<std::size_t>(along) *
                                    static_cast<std::size_t>(along),
                                no_cube) {
    Vector3f highest = -lowest_;
    for (const Vector3f& place : places)
      if (is_near(place)) {
        lowest_ = lowest_.cwiseMin(place);
        highest = highest.cwiseMax(place);
      }
    side_m_ = (highest - lowest_).maxCoeff() / static_cast<float>(along);
  }

  /// Returns the number of the cube that a place is in.
  std::uint32_t number_of(const Vector3f& place) {
    if (!is_near(place) || !(side_m_ > 0.0F)) return no_cube;
    std::size_t at = 0;
    for (const float from_lowest :
         {place.x() - lowest_.x(), place.y() - lowest_.y(), place.z() - lowest_.z()})
      at = at * static_cast<std::size_t>(along_) +
           static_cast<std::size_t>(std::min(along_ - 1, static_cast<int>(from_lowest / side_m_)));
    if (numbers_[at] == no_cube) numbers_[at] = count_++;
    return numbers_[at];
  }
  std::size_t count() const noexcept { return count_; }

private:
  static bool is_near(const Vector3f& place) noexcept {
    return std::abs(place.x()) < far_place_m && std::abs(place.y()) < far_place_m &&
           std::abs(place.z()) < far_place_m;
  }

  int along_;
  Vector3f lowest_ = Vector3f::Constant(far_place_m);
  float side_m_ = 0.0F;
  std::vector<std::uint32_t> numbers_;
  std::uint32_t count_ = 0;
};

} // namespace

bool is_dense(const Surface& surface) noexcept {
  return surface.places.size() > dense_places;
}

Surface coarse_surface(const Surface& surface, int cubes) {
  Cubes grid(surface.places, cubes);
  std::vector<std::uint32_t> cube_of;
  cube_of.reserve(surface.places.size());
  for (const Vector3f& place : surface.places)
    cube_of.push_back(grid.number_of(place));
  std::vector<Eigen::Vector4d> sums(grid.count(), Eigen::Vector4d::Zero()); // the last: how many
  for (std::size_t at = 0; at < cube_of.size(); ++at)
    if (cube_of[at] != no_cube) {
      sums[cube_of[at]].head<3>() += surface.places[at].cast<double>();
      sums[cube_of[at]].w() += 1.0;
    }
  Surface coarse;
  coarse.material = surface.material;
  for (const Eigen::Vector4d& sum : sums)
    coarse.places.emplace_back((sum.head<3>() / sum.w()).cast<float>());
  for (std::size_t at = 0; at + 2 < surface.corners.size(); at += 3) {
    const std::uint32_t a = cube_of[surface.corners[at]];
    const std::uint32_t b = cube_of[surface.corners[at + 1]];
    const std::uint32_t c = cube_of[surface.corners[at + 2]];
    if (a == b || b == c || c == a || a == no_cube || b == no_cube || c == no_cube) continue;
    coarse.corners.insert(coarse.corners.end(), {a, b, c});
  }
  return coarse;
}

} // namespace nendo::render
