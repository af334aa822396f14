#pragma once
// Where two surfaces cross: points, each named by an edge of one and a face of the other, and the
// segments between them. Whether an edge goes through a face is decided exactly; where, in double.

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/box_tree.hpp"
#include "join/triangle_surface.hpp"

namespace nendo::deform {

struct Crossing {
  std::uint32_t part;     ///< 0 or 1: whose edge it is
  std::uint32_t from, to; ///< the edge's points, the lesser number first
  std::uint32_t face;     ///< the crossed face of the other part
  double along;           ///< 0 at `from`, 1 at `to`
  SpacePoint place;
};

struct CrossingSegment {
  std::array<std::uint32_t, 2> ends;  ///< crossings
  std::array<std::uint32_t, 2> faces; ///< one of each part, both of which it lies in
};

struct Crossings {
  std::vector<Crossing> points;
  std::vector<CrossingSegment> segments;
};

/// The places of a part's points may be others than those of its surface.
struct CrossedPart {
  std::span<const SpacePoint> points;
  std::span<const Corners> faces;
  const BoxTree* tree; ///< a tree of these faces
};

/// Finds all crossings. Returns false if the parts are not in general position: a point of one lies
/// in a face's plane of the other, or an edge meets an edge. Then the crossings are not complete.
bool find_crossings(const std::array<CrossedPart, 2>& parts, Crossings& crossings);

/// Returns 1 if the place is inside of the closed surface, 0 if it is outside, and -1 if that
/// cannot be decided, because the place is on the surface. Decided by a ray, exactly.
int is_inside(const SpacePoint& place, const CrossedPart& part);

} // namespace nendo::deform
