#pragma once
// A closed surface of triangles of which necks are cut, and sheets joined.

#include <array>
#include <cstdint>
#include <set>
#include <span>
#include <vector>

#include "join/triangle_surface.hpp"
#include "mesh/surface_mesh.hpp"

namespace nendo::deform {

using Triple = std::array<std::uint32_t, 3>;

class ThinSurface : private SurfaceMesh {
public:
  /// The surface must be closed and two-manifold. Allocates.
  explicit ThinSurface(TriangleSurface surface);

  using SurfaceMesh::corners;
  using SurfaceMesh::edge_between;
  using SurfaceMesh::face_count;
  using SurfaceMesh::from;
  using SurfaceMesh::last;
  using SurfaceMesh::point_count;

  std::span<const SpacePoint> points() const noexcept { return surface_.points; }
  const SpacePoint& point(std::uint32_t number) const noexcept { return surface_.points[number]; }
  /// How long edges should be at a point.
  double wanted(std::uint32_t number) const noexcept {
    return surface_.detail.empty() ? mean_edge_ : static_cast<double>(surface_.detail[number].edge);
  }
  /// Returns the neighbours of a point, counter-clockwise; nothing if it is gone.
  std::vector<std::uint32_t> ring(std::uint32_t number) const;
  bool are_neighbours(std::uint32_t a, std::uint32_t b) const {
    return edge_between(a, b) != no_index;
  }

  /// Cuts along three points whose edges bound no face, and closes both ends. Those ends are apart
  /// by a quarter of an edge. Returns false, and does nothing, if one of them would be a crumb.
  bool part(const Triple& loop);
  /// Takes the faces around points away, and islands between them, and joins the two rims that are
  /// left. Returns how many patches the faces were: two, or one, around a hole that becomes wider.
  /// 0: it cannot be done, and nothing has happened.
  int join_rims(const std::vector<std::uint32_t>& points);

  /// Of the faces since the last call, the new ones and those that were moved.
  std::vector<std::uint32_t> take_changed();
  /// Returns the surface without what is gone. The object is empty afterwards.
  TriangleSurface take(Renumbering& numbers);

private:
  /// Of faces, in their direction; and the points that they would meet twice.
  struct Rims {
    std::vector<std::vector<std::uint32_t>> loops;
    std::vector<std::uint32_t> doubled;
  };
  struct SideOfLoop {
    std::vector<std::uint32_t> faces; ///< at the loop
    SpacePoint middle;                ///< the middle of their points beyond it
  };
  std::uint32_t other_face(std::uint32_t edge) const noexcept { return twin(edge) / 3; }
  Triple faces_beside(std::uint32_t face) const noexcept {
    return {other_face(3 * face), other_face(3 * face + 1), other_face(3 * face + 2)};
  }
  bool find_sides(const Triple& loop, SideOfLoop& left, SideOfLoop& right) const;
  bool is_crumb(const Triple& loop, const SideOfLoop& side, const SideOfLoop& other) const;
  std::set<std::uint32_t> faces_around(const std::vector<std::uint32_t>& points) const;
  Rims rims_of(const std::set<std::uint32_t>& faces) const;
  std::set<std::uint32_t> without_islands(std::set<std::uint32_t> faces) const;
  bool fill(const std::vector<std::uint32_t>& rim, std::set<std::uint32_t>& faces) const;
  int count_patches(const std::set<std::uint32_t>& faces) const;
  bool are_tied(std::uint32_t a, std::uint32_t b, const std::set<std::uint32_t>& without) const;
  std::vector<Corners> between(const std::vector<std::uint32_t>& u,
                               const std::vector<std::uint32_t>& v) const;
  void add_face(const Corners& corners, std::uint32_t like);
  void note_around(std::uint32_t number);

  TriangleSurface surface_; ///< the columns; the mesh has the faces
  std::vector<std::uint32_t> changed_;
  double mean_edge_ = 0.0;
};

} // namespace nendo::deform
