#pragma once
// Shadow maps: which places a direction's light reaches.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "render/raster.hpp"
#include "render/surface.hpp"

namespace nendo::render {

/// Coordinates of places or directions, each in an array of its own, so that several are computed
/// at once.
struct Coordinates {
  explicit Coordinates(std::span<const Eigen::Vector3f> places);
  std::size_t size() const noexcept { return x.size(); }

  std::vector<float> x, y, z;
};

/// A surface that casts shadows.
struct Caster {
  explicit Caster(const Surface& surface)
      : places(surface.places), coordinates(surface.places), corners(surface.corners) {}

  std::span<const Eigen::Vector3f> places;
  Coordinates coordinates;                ///< the same
  std::span<const std::uint32_t> corners; ///< three for each triangle
};

/// Some places that are computed at once.
constexpr std::size_t block_places = 256;
using BlockOfFloats = std::array<float, block_places>;
struct PlaceBlock {
  BlockOfFloats x{}, y{}, z{};
};
using LitBlock = std::array<bool, block_places>;

/// The depth of a scene along a direction. For each sample of a square, it keeps the place that is
/// nearest to the light.
class DepthMap {
public:
  /// `toward` is a unit vector to the light, and `side` is the number of samples along each side.
  DepthMap(std::span<const Caster> casters, const Eigen::Vector3f& toward, int side);

  /// Sets for each place whether nothing is nearer to the light than it by more than slack_m.
  /// Outside of the map, everything is lit.
  void find_lit(const PlaceBlock& places, float slack_m, LitBlock& lit) const noexcept;
  /// Returns the lit part, 0 to 1, of the samples within `reach` samples of `place`. It gives a
  /// shadow a soft edge.
  float lit_part(const Eigen::Vector3f& place, float slack_m, int reach) const noexcept;
  float sample_m() const noexcept { return sample_m_; }

private:
  /// A unit vector. The order of the sum is part of a picture's bytes.
  struct Axis {
    float of(float at_x, float at_y, float at_z) const noexcept {
      return x * at_x + (y * at_y + z * at_z);
    }
    float x = 0.0F, y = 0.0F, z = 0.0F;
  };

  /// The places of a surface on the map.
  struct OnMap {
    std::vector<GridCorner> grid;
    std::vector<std::uint32_t> cells; ///< between which middles of samples; see cell_of()
  };

  void frame(std::span<const Caster> casters);
  void put(const Coordinates& places, OnMap& on) const;
  void cast(const Caster& caster, const OnMap& on);
  void cast_triangle(std::span<const Eigen::Vector3f> places,
                     std::span<const std::uint32_t, 3> corners,
                     const std::vector<GridCorner>& grid);

  Axis across_, up_, toward_;
  float left_ = 0.0F, bottom_ = 0.0F; ///< the map's corner, along across_ and up_
  float sample_m_ = 0.0F;             ///< 0: there is nothing
  int side_;
  /// Along toward_; the lowest float where there is nothing. One more is for what is outside.
  std::vector<float> nearest_;
};

} // namespace nendo::render
