#pragma once
// Which edges of faces run against each other: of triangles that change (SurfaceMesh), and of
// polygons that do not (HalfEdges).

#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/index.hpp>

#include "geometry/rows_by_key.hpp"
#include "geometry/space.hpp"

namespace nendo::deform {

/// The edges of polygons, as numbers of corners: corner k begins the edge from this corner to the
/// next one of its face. SurfaceMesh cannot replace this: the diagonals of triangles would be edges
/// that the model does not have, and checks name edges of the model.
struct HalfEdges {
  std::vector<std::uint32_t> next; ///< the edge after it in its face
  std::vector<std::uint32_t> last; ///< the edge before it
  /// The edge of another face that goes the other way; no_index if there is none, or several.
  std::vector<std::uint32_t> twin;
  RowsByKey<std::uint32_t> out; ///< the edges that begin at each vertex, in rising order
};

/// Returns a key for maps: the edge from one vertex to another.
inline std::uint64_t edge_key(std::uint32_t from, std::uint32_t to) noexcept {
  return std::uint64_t{from} << 32 | to;
}

/// Each corner must be below `vertices`. Allocates.
HalfEdges half_edges_of(std::span<const std::uint32_t> face_starts,
                        std::span<const std::uint32_t> face_corners, std::size_t vertices);

/// The same as the public function, if the edges are known.
ManifoldCheck check_closed_manifold(std::span<const std::uint32_t> face_starts,
                                    std::span<const std::uint32_t> face_corners,
                                    const HalfEdges& edges);

/// The new number of each point and of each face; no_index for those that are gone.
struct Renumbering {
  std::vector<std::uint32_t> points, faces;
};

/// Triangles that know their neighbours while they are split, flipped, collapsed, removed and
/// added: the structure of each editor of a surface (refinement, joining, changes of topology).
///
/// It has numbers only. Attributes of points, faces or edges are columns beside it, which have one
/// entry for each number; the editor of the mesh lets them grow with it. Numbers of points and
/// faces that are gone are not used again, until take() renumbers what is left.
class SurfaceMesh {
public:
  SurfaceMesh() = default;
  /// Corners must be below `points`. Edges that do not have exactly one edge against them are at
  /// the boundary. Allocates, as all functions that add something do.
  SurfaceMesh(std::vector<Corners> faces, std::size_t points);

  // Edge 3 f + k goes from corner k of face f to its next corner. Its twin runs back.
  static std::uint32_t next(std::uint32_t edge) noexcept {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
  }
  static std::uint32_t last(std::uint32_t edge) noexcept {
    return edge % 3 == 0 ? edge + 2 : edge - 1;
  }
  std::uint32_t from(std::uint32_t edge) const noexcept { return faces_[edge / 3][edge % 3]; }
  std::uint32_t to(std::uint32_t edge) const noexcept { return from(next(edge)); }
  /// Returns both ends of an edge, and the points opposite to it in its face and in its twin's.
  std::array<std::uint32_t, 4> points_at(std::uint32_t edge) const noexcept {
    const std::uint32_t back = twins_[edge];
    return {from(edge), from(back), from(last(edge)), from(last(back))};
  }
  /// no_index at the boundary
  std::uint32_t twin(std::uint32_t edge) const noexcept { return twins_[edge]; }

  // Counts include what is gone.
  std::uint32_t point_count() const noexcept { return to_index(edge_at_.size()); }
  std::uint32_t face_count() const noexcept { return to_index(faces_.size()); }
  /// Returns whether some face has the point.
  bool has_point(std::uint32_t point) const noexcept { return edge_at_[point] != no_index; }
  bool has_face(std::uint32_t face) const noexcept { return faces_[face][0] != no_index; }
  const Corners& corners(std::uint32_t face) const noexcept { return faces_[face]; }

  /// Calls visit(edge) for the edges that begin where `first` does, counter-clockwise from it on.
  /// None of their faces may be at the boundary there.
  template <class Visit>
  void visit_edges_from(std::uint32_t first, const Visit& visit) const {
    std::uint32_t edge = first;
    do {
      const std::uint32_t after = twins_[last(edge)];
      visit(edge);
      edge = after;
    } while (edge != first);
  }
  /// The same of a point that has_point().
  template <class Visit>
  void visit_edges(std::uint32_t point, const Visit& visit) const {
    visit_edges_from(edge_at_[point], visit);
  }
  /// Returns the edge from one point to another, or no_index.
  std::uint32_t edge_between(std::uint32_t one, std::uint32_t other) const;

  std::uint32_t add_point();
  /// Its edges become twins of boundary edges that run back. Returns the face's number.
  std::uint32_t add_face(const Corners& corners);
  void remove_faces(std::span<const std::uint32_t> faces);
  /// Halves an edge by a new point, and both of its faces. Each face keeps the half at its edge's
  /// beginning. The last two faces have the other halves, the edge's own face first. Returns the
  /// point.
  std::uint32_t split(std::uint32_t edge);
  /// Whether the surface would stay two-manifold.
  bool can_collapse(std::uint32_t edge) const;
  /// The edge's end goes into its beginning, and both of its faces go.
  void collapse(std::uint32_t edge);
  /// Whether no edge would be there twice, and no point would keep less than three faces.
  bool can_flip(std::uint32_t edge) const;
  /// Turns the edge in its two faces, clockwise.
  void flip(std::uint32_t edge);
  /// Opens the surface along a loop, each of whose edges ends where the next one begins. What is on
  /// the right of the loop gets new points instead of the loop's, in their order. Both sides are at
  /// the boundary then.
  void open(std::span<const std::uint32_t> loop);

  /// Returns the faces that are left, in their order. The mesh is empty afterwards.
  std::vector<Corners> take(Renumbering& numbers);

private:
  std::uint32_t split_face(std::uint32_t edge, std::uint32_t point);
  void link(std::uint32_t edge, std::uint32_t twin);

  std::vector<Corners> faces_; ///< removed faces have corners no_index
  std::vector<std::uint32_t> twins_;
  std::vector<std::uint32_t> edge_at_;                        ///< an edge that begins at each point
  std::unordered_map<std::uint64_t, std::uint32_t> boundary_; ///< edges, by the points of both ends
};

} // namespace nendo::deform
