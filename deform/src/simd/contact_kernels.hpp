#pragma once
// Distances of vertices from the parts of a body, a block at a time. All numbers are in a layout's
// coordinates (BlockLayout).

#include <array>
#include <cstddef>
#include <cstdint>

#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// A rounded cone. The nearest of its balls is at the share along + tilt * across of the way.
struct ConeEntry {
  float x, y, z; ///< where it begins
  std::array<float, 3> way;
  float squared_length;
  float inverse_squared; ///< 0 if one ball contains the other: it is then that ball
  float tilt;
  float radius, growth;
};

/// The inside of a rounded triangle; its edges are cones.
struct PlaneEntry {
  float x, y, z;
  std::array<float, 3> normal;
  std::array<float, 3> slope; ///< of the radius, in the plane
  float tilt;
  std::array<float, 3> first,
      second; ///< a place's barycentric coordinates: its products with these
  float radius;
};

inline constexpr std::uint32_t no_plane = ~std::uint32_t{0};

struct PartEntry {
  std::uint32_t first_cone, cone_count;
  std::uint32_t plane; ///< or no_plane
};

struct PartArrays {
  const ConeEntry* cones;
  const PlaneEntry* planes;
  const PartEntry* parts;
};

/// For each vertex of a block: the distance from the nearest part, negative inside; the centre of
/// the ball of that part that is nearest, from which the normal points to the vertex; and the
/// part's number.
struct alignas(64) NearestLanes {
  std::array<float, block_size> distance, x, y, z, part;
};

/// Of the listed parts; `count` > 0.
void nearest_in_block(const VertexBlock& block, const PartArrays& arrays, const std::uint32_t* list,
                      std::size_t count, NearestLanes& nearest) noexcept;

/// Boxes by their middles and half sides.
struct BoxLanes {
  VertexBlock middles{}, halves{};
};

/// For each box and the part: how far the box' middle is from it, and a distance that no place of
/// the box falls short of. A part is convex, and so is its distance, which is therefore nowhere
/// less than the tangent at the middle.
void part_from_boxes(const BoxLanes& boxes, const PartArrays& arrays, std::uint32_t part,
                     float* distances, float* least) noexcept;

/// As bounds_of(), but faster.
BlockBounds fast_bounds_of(const VertexBlock& block) noexcept;

} // namespace nendo::deform
