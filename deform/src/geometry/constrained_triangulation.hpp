#pragma once
// A constrained Delaunay triangulation of the plane: points one after another, flips towards
// Delaunay, and segments by flips (S. W. Sloan, A fast algorithm for generating constrained
// Delaunay triangulations, 1993). All decisions are exact, so the result is a triangulation
// whatever the points are, and the same calls give the same triangles.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/exact_predicates.hpp"

namespace nendo::deform {

/// Why a point or a segment was not taken. Then nothing has changed, except that edges may have
/// been flipped.
enum class PlaneFault {
  none,
  outside,    ///< the point lies far outside of the box
  same_point, ///< there is a point in this place
  on_segment, ///< the point lies on a segment
  on_point,   ///< a point lies on the segment
  crossing,   ///< the segment crosses another one
};

/// The triangles that triangles() returns.
enum class PlaneFill {
  enclosed, ///< those that segments separate from outside
  odd, ///< those that an odd number of segments separates from outside; segments form closed loops
};

class ConstrainedTriangulation {
public:
  using Triangle = std::array<std::uint32_t, 3>;

  /// The box should hold all points. Its size sets how far away the corners of the triangle are
  /// that holds everything.
  ConstrainedTriangulation(const PlanePoint& lowest, const PlanePoint& highest);

  /// Reserves memory for this number of points, which saves time only.
  void reserve(std::size_t points);
  /// Adds a point. The k-th point that was taken has the number k, from 0.
  PlaneFault add(const PlanePoint& point);
  /// Makes the edge from one point to another a segment, which stays. The points must differ. To
  /// make an edge a segment twice does nothing.
  PlaneFault constrain(std::uint32_t from, std::uint32_t to);
  /// Flips edges that are no segments until the triangulation is Delaunay as far as the segments
  /// let it. After add() it is so if no segment was added by flips before.
  void improve();

  std::size_t point_count() const noexcept { return points_.size() - 3; }
  const PlanePoint& point(std::uint32_t number) const noexcept { return points_[number + 3]; }
  /// Returns triangles of the points' numbers, which turn to the left. None has a corner outside if
  /// the segments form closed loops. Allocates.
  std::vector<Triangle> triangles(PlaneFill fill) const;

private:
  // Edge 3 t + k goes from corner k of triangle t to its next corner. corners_ has the point where
  // an edge begins, twins_ the same edge of the triangle beyond.
  static std::uint32_t next(std::uint32_t edge) noexcept {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
  }
  static std::uint32_t last(std::uint32_t edge) noexcept {
    return edge % 3 == 0 ? edge + 2 : edge - 1;
  }
  int side(std::uint32_t from, std::uint32_t to, std::uint32_t point) const noexcept;
  bool is_convex(std::uint32_t edge) const noexcept;
  bool should_flip(std::uint32_t edge) const noexcept;
  void set(std::uint32_t edge, std::uint32_t corner, std::uint32_t twin, bool fixed) noexcept;
  void flip(std::uint32_t edge) noexcept;
  struct Place;
  Place locate(const PlanePoint& point) const noexcept;
  template <std::size_t count>
  void surround(std::uint32_t point, const std::array<std::uint32_t, count>& around,
                const std::array<std::uint32_t, count>& made);
  void split_triangle(std::uint32_t triangle, std::uint32_t point);
  void split_edge(std::uint32_t edge, std::uint32_t point);
  void legalise();
  std::uint32_t edge_between(std::uint32_t from, std::uint32_t to) const noexcept;
  PlaneFault collect_crossed(std::uint32_t from, std::uint32_t to);
  void flip_crossed(std::uint32_t from, std::uint32_t to);
  std::vector<std::uint32_t> segments_from_outside() const;

  std::vector<PlanePoint> points_; ///< the first three are the outer triangle
  std::vector<std::uint32_t> corners_;
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint8_t> fixed_;
  std::vector<std::uint32_t> edge_from_; ///< some edge that begins at each point
  std::vector<std::uint32_t> stack_;
  std::vector<std::array<std::uint32_t, 2>> crossed_; ///< right end, left end
  std::uint32_t start_ = 0;                           ///< the edge where the next search begins
};

} // namespace nendo::deform
