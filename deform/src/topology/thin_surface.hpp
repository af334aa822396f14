#pragma once
// A closed surface of triangles of which necks are cut, and sheets joined.

#include <array>
#include <cstdint>
#include <set>
#include <vector>

#include "join/triangle_surface.hpp"

namespace nendo::deform {

using Triple = std::array<std::uint32_t, 3>;

class ThinSurface {
public:
  /// The surface must be closed and two-manifold. Allocates.
  explicit ThinSurface(TriangleSurface surface);

  const TriangleSurface& surface() const noexcept { return surface_; }
  std::uint32_t point_count() const noexcept {
    return static_cast<std::uint32_t>(surface_.points.size());
  }
  const SpacePoint& point(std::uint32_t number) const noexcept { return surface_.points[number]; }
  /// How long edges should be at a point.
  double wanted(std::uint32_t number) const noexcept {
    return surface_.detail.empty() ? mean_edge_ : static_cast<double>(surface_.detail[number].edge);
  }
  /// Returns the neighbours of a point, counter-clockwise; nothing if it is gone.
  std::vector<std::uint32_t> ring(std::uint32_t number) const;
  /// Returns the face with the edge from one to the other, or no_index.
  std::uint32_t face_with(std::uint32_t from, std::uint32_t to) const noexcept;
  bool are_neighbours(std::uint32_t a, std::uint32_t b) const noexcept {
    return face_with(a, b) != no_index;
  }
  /// Twice the area vector of the faces around.
  SpacePoint normal(std::uint32_t number) const;

  /// Cuts along three points whose edges bound no face, and closes both ends. Those ends are apart
  /// by a quarter of an edge. Returns false, and does nothing, if one of them would be a crumb.
  bool part(const Triple& loop);
  /// Takes the faces around points away, and islands between them, and joins the two rims that are
  /// left. Returns how many patches the faces were: two, or one, around a hole that becomes wider.
  /// 0: it cannot be done, and nothing has happened.
  int join_rims(const std::vector<std::uint32_t>& points);

  /// Of the faces since the last call, the new ones and those that were moved.
  std::vector<std::uint32_t> take_changed();
  /// Returns the surface without what is gone. `numbers` becomes each point's new number, or
  /// no_index; `faces`, each face's. The object is empty afterwards.
  TriangleSurface take(std::vector<std::uint32_t>& numbers, std::vector<std::uint32_t>& faces);

private:
  /// Of faces, in their direction; and the points that they would meet twice.
  struct Rims {
    std::vector<std::vector<std::uint32_t>> loops;
    std::vector<std::uint32_t> doubled;
  };
  struct SideOfLoop {
    std::vector<std::uint32_t> faces; ///< at the loop
    SpacePoint middle;                ///< of what they reach beyond it
  };
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
  std::uint32_t copy_point(std::uint32_t number);
  void add_face(const Corners& corners, std::uint32_t like);
  void remove_face(std::uint32_t face);
  void note_around(std::uint32_t number);

  TriangleSurface surface_;
  std::vector<std::vector<std::uint32_t>> faces_at_; ///< of each point
  std::vector<char> gone_;                           ///< of each face
  std::vector<std::uint32_t> changed_;
  double mean_edge_ = 0.0;
};

} // namespace nendo::deform
