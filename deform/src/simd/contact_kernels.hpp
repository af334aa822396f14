#pragma once
// What clay computes of a block at a time where bodies touch: the distances of vertices from parts,
// the nearest vertices, their loads, and which places and boxes are near each other. All numbers
// are in a layout's coordinates (BlockLayout).

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
  std::array<float, 3> slope; ///< the radius' slope in the plane
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

/// Cells of space: a coordinate's cell is what is whole of coordinate * per_length + shift, from 0
/// to `most`.
struct SpaceCells {
  float per_length, shift, most;
};
/// Of the vertices nearer than `margin`, lists the nearest of each cell and part, the nearest
/// first, and of those that are equally near the first. Cells 1024 apart are taken for one. Returns
/// how many there are.
std::size_t nearest_of_cells(const VertexBlock& block, const NearestLanes& nearest, float margin,
                             const SpaceCells& cells,
                             std::array<std::uint8_t, block_size>& lanes) noexcept;

/// Boxes by their middles and half sides.
struct BoxLanes {
  VertexBlock middles{}, halves{};
};

/// A part seen from the middles of boxes: how far they are, and the direction away from it there.
struct alignas(64) PartFromBoxes {
  std::array<float, block_size> distance, x, y, z;
  /// What no place of a box falls short of. A part is convex, and so is its distance, which is
  /// therefore nowhere less than the tangent at the middle.
  std::array<float, block_size> least;
};
/// The part that is the nearest to each middle, and how far the centre of its nearest ball is.
struct alignas(64) NearestFromBoxes {
  std::array<float, block_size> distance, x, y, z, to_centre;
};

/// Sets `seen`, and makes the part the nearest where it is nearer than `nearest`.
void part_from_boxes(const BoxLanes& boxes, const PartArrays& arrays, std::uint32_t part,
                     PartFromBoxes& seen, NearestFromBoxes& nearest) noexcept;
/// Returns a bit for each box: whether the part may be within `margin` of a place of the box and
/// nearer to one than the nearest part is. A place is at most as far from that as from the ball
/// that is the nearest to the middle; so how much farther the part is can be bounded by the two
/// directions.
std::uint64_t near_in_boxes(const BoxLanes& boxes, const PartFromBoxes& seen,
                            const NearestFromBoxes& nearest, float margin) noexcept;

/// Adds each vertex' depth to its load, up to `most`; a vertex farther than `most` has none any
/// more. Returns whether some load is left.
bool add_loads(const NearestLanes& nearest, float most, float* loads) noexcept;

/// Coordinates of places, and of the normals there, in rows of a multiple of this many.
using PlaceRows = std::array<const float*, 6>;
inline constexpr std::size_t place_lanes = 64;
/// Returns whether one of the first `count` places is nearer to `place` than the root of `squared`
/// and has a normal within 60 degrees of its one. What follows them must be far away.
bool is_crowded(const PlaceRows& rows, std::size_t count, const std::array<float, 6>& place,
                float squared) noexcept;

/// The sides of boxes, a row each: lowest x, y, z, and negated highest y, z.
using BoxRows = std::array<const float*, 5>;
/// Returns a bit for each of the `block_size` boxes from `first` on: whether it overlaps that box
/// in y and z, and begins before the box ends in x. `sides`: lowest x, y, z, 0, negated highest x,
/// y, z.
std::uint64_t boxes_in_way(const BoxRows& rows, std::size_t first,
                           const std::array<float, 8>& sides) noexcept;

} // namespace nendo::deform
