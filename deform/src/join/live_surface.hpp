#pragma once
// A closed surface whose triangles change: edges are split, collapsed and flipped. Attributes
// follow, and each operation is refused where it would fold the surface, change its topology, or
// tear a border between materials, names or texture islands.

#include <cstdint>
#include <vector>

#include <nendo/deform/refinement.hpp>

#include "join/triangle_surface.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {

struct CollapseLimits {
  double longest = 0.0;    ///< no edge becomes longer, unless one around the point was
  double thin = 0.0;       ///< the normals of faces that are lower say nothing
  double min_cosine = 0.5; ///< the least cosine of the angle by which a face's normal turns
};

class LiveSurface : private SurfaceMesh {
public:
  /// The surface must be closed and two-manifold (closed_manifold.hpp). Allocates.
  explicit LiveSurface(TriangleSurface surface);

  using SurfaceMesh::edge_between;
  using SurfaceMesh::face_count;
  using SurfaceMesh::from;
  using SurfaceMesh::has_face;
  using SurfaceMesh::has_point;
  using SurfaceMesh::point_count;
  using SurfaceMesh::to;
  using SurfaceMesh::twin;
  using SurfaceMesh::visit_edges;

  const SpacePoint& point(std::uint32_t number) const noexcept { return surface_.points[number]; }
  void move(std::uint32_t number, const SpacePoint& to) noexcept { surface_.points[number] = to; }
  /// What refining must know of each point; none at all, if it was not given.
  const std::vector<VertexDetail>& detail() const noexcept { return surface_.detail; }
  void set_detail(std::vector<VertexDetail> detail);
  double edge_length(std::uint32_t edge) const noexcept {
    return distance_between(point(from(edge)), point(to(edge)));
  }
  /// Faces on both sides differ in material or names, or texture is cut there.
  bool is_border(std::uint32_t edge) const noexcept;

  /// Puts a new point into the middle of an edge, and returns its number: point_count() before.
  std::uint32_t split(std::uint32_t edge);
  /// Lets the edge's end go into its beginning, which stays in its place. Returns false if it is
  /// refused.
  bool collapse(std::uint32_t edge, const CollapseLimits& limits);
  /// Turns the edge in its two faces if that makes the worse of them fairer. Returns false if it is
  /// refused.
  bool flip(std::uint32_t edge);

  /// Does what was done before to a surface of the same faces, wherever its points are. Returns
  /// false, and does nothing, if that cannot be done to this one.
  bool repeat(const EdgeOperation& operation);
  /// Appends each operation from now on to that list, which must live as long.
  void note_in(std::vector<EdgeOperation>* list) noexcept { noted_ = list; }

  /// Returns the surface without what is gone, points and faces in their order. `numbers`, if not
  /// null, becomes each point's new number, or no_index. The object is empty afterwards.
  TriangleSurface take(std::vector<std::uint32_t>* numbers = nullptr);

private:
  std::uint32_t texture(std::uint32_t edge) const noexcept {
    return surface_.face_texture[edge / 3][edge % 3];
  }
  void set_texture(std::uint32_t edge, std::uint32_t texture) noexcept {
    surface_.face_texture[edge / 3][edge % 3] = texture;
  }
  std::uint32_t middle_texture(std::uint32_t edge);
  void split_look(std::uint32_t edge, std::uint32_t middle_texture);
  SpacePoint area_of(std::uint32_t face) const noexcept;
  void add_attributes(std::uint32_t a, std::uint32_t b);
  void note(EdgeOperation::Kind kind, std::uint32_t a, std::uint32_t b) {
    if (noted_ != nullptr) noted_->push_back({kind, a, b});
  }
  bool can_collapse(std::uint32_t edge) const {
    return SurfaceMesh::can_collapse(edge) && keeps_borders(edge);
  }
  void collapse_now(std::uint32_t edge);
  void move_texture(std::uint32_t edge);
  bool makes_fairer(std::uint32_t edge) const;
  bool can_flip(std::uint32_t edge) const {
    return !is_border(edge) && SurfaceMesh::can_flip(edge);
  }
  void flip_now(std::uint32_t edge);
  bool keeps_borders(std::uint32_t edge) const;
  bool keeps_shape(std::uint32_t edge, const CollapseLimits& limits) const;

  TriangleSurface surface_; ///< the columns; the mesh has the faces
  std::vector<EdgeOperation>* noted_ = nullptr;
};

/// From 0 for a triangle without area to 1 for an equilateral one.
double triangle_fairness(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept;

} // namespace nendo::deform
