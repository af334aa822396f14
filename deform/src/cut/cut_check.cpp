#include "cut/cut_check.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include <nendo/deform/triangles.hpp>

#include "geometry/box_tree.hpp"
#include "geometry/triangle_meeting.hpp"
#include "mesh/columns.hpp"

namespace nendo::deform {
namespace {

/// The triangles of one side of the cut.
struct CutSide {
  std::vector<Corners> triangles; ///< pieces of crossed faces, and then cut faces
  std::size_t pieces = 0;
  std::vector<Corners> near; ///< faces that may meet cut faces
};

Corners corners_of_face(const Mesh& mesh, std::size_t face) noexcept {
  const std::uint32_t begin = mesh.face_starts[face];
  return {mesh.face_corners[begin], mesh.face_corners[begin + 1], mesh.face_corners[begin + 2]};
}

class CutCheck {
public:
  CutCheck(const CutAssembly& assembly, const CutSurface& surface, const Points& rest, double reach)
      : assembly_(assembly), mesh_(assembly.mesh), rest_(rest), surface_(surface), reach_(reach),
        first_added_(static_cast<std::uint32_t>(static_cast<std::size_t>(mesh_.vertices.cols()) -
                                                assembly.added.size())) {}
  bool is_sound(bool up) const;

private:
  CutSide side_of(bool up) const;
  bool is_up(std::uint32_t face) const noexcept;
  void add_near(bool up, std::vector<Corners>& triangles) const;
  bool is_inner(const Corners& triangle) const noexcept;

  const CutAssembly& assembly_;
  const Mesh& mesh_;
  const Points& rest_; ///< of the vertices that were there before: all of faces that are not cut
  const CutSurface& surface_;
  double reach_; ///< no face whose corners are all farther from the blade can meet cut faces
  std::uint32_t first_added_;
  std::vector<SpacePoint> points_ = space_points(mesh_.vertices);
};

/// A piece has at least one corner that was there before.
bool CutCheck::is_up(std::uint32_t face) const noexcept {
  for (const std::uint32_t corner : corners_of_face(mesh_, face))
    if (corner < surface_.vertex_count()) return surface_.is_up(corner);
  return false;
}

void CutCheck::add_near(bool up, std::vector<Corners>& triangles) const {
  const std::uint32_t old = surface_.vertex_count();
  FaceTriangles of_faces(mesh_, rest_);
  for (std::size_t face = 0; face < assembly_.first_cut_face; ++face) {
    const std::uint32_t begin = mesh_.face_starts[face];
    const std::uint32_t end = mesh_.face_starts[face + 1];
    double nearest = std::numeric_limits<double>::infinity();
    double longest = 0.0;
    bool belongs = true;
    for (std::uint32_t at = begin; at < end && belongs; ++at) {
      const std::uint32_t corner = mesh_.face_corners[at];
      belongs = corner < old && surface_.is_up(corner) == up;
      if (!belongs) break;
      nearest = std::min(nearest, std::abs(surface_.above(corner)));
      const SpacePoint edge = points_[corner] - points_[mesh_.face_corners[begin]];
      longest = std::max(longest, dot(edge, edge));
    }
    if (!belongs || nearest > reach_ + 1.5 * std::sqrt(longest)) continue;
    for (const auto& [a, b, c] : of_faces.of(face))
      triangles.push_back({mesh_.face_corners[a], mesh_.face_corners[b], mesh_.face_corners[c]});
  }
}

CutSide CutCheck::side_of(bool up) const {
  CutSide side;
  for (const std::uint32_t face : assembly_.cut_pieces)
    if (is_up(face) == up) side.triangles.push_back(corners_of_face(mesh_, face));
  side.pieces = side.triangles.size();
  const std::size_t half = (mesh_.face_count() - assembly_.first_cut_face) / 2;
  const std::size_t first = assembly_.first_cut_face + (up ? 0 : half);
  for (std::size_t face = first; face < first + half; ++face)
    side.triangles.push_back(corners_of_face(mesh_, face));
  // A plane has all faces that it does not cross on one side, far beyond rounding.
  if (reach_ > 0.0) add_near(up, side.near);
  return side;
}

/// Cut faces of a plane that do not touch its rim lie amid other cut faces of the same plane.
bool CutCheck::is_inner(const Corners& triangle) const noexcept {
  return std::all_of(triangle.begin(), triangle.end(), [&](std::uint32_t corner) {
    return assembly_.added[corner - first_added_].from == no_index;
  });
}

/// The cut faces of both sides lie in the same places, so they are compared among themselves only
/// on the upper side.
bool CutCheck::is_sound(bool up) const {
  const CutSide side = side_of(up);
  const std::vector<Corners>& triangles = side.triangles;
  const BoxTree tree(points_, triangles);
  const auto meets = [&](const Corners& triangle, const auto& is_asked) {
    const SpaceBox box = box_around(points_, triangle);
    return tree.any([&](const SpaceBox& other) { return meet(box, other); },
                    [&](std::uint32_t other) {
                      return is_asked(other) && triangles_meet(points_, triangle, triangles[other]);
                    });
  };
  for (std::uint32_t piece = 0; piece < side.pieces; ++piece)
    if (meets(triangles[piece], [&](std::uint32_t other) { return other > piece; })) return false;
  for (const Corners& triangle : side.near)
    if (meets(triangle, [&](std::uint32_t other) { return other >= side.pieces; })) return false;
  if (!up) return true;
  for (auto face = static_cast<std::uint32_t>(side.pieces); face < triangles.size(); ++face) {
    const Corners& corner = triangles[face];
    if (is_degenerate(points_[corner[0]], points_[corner[1]], points_[corner[2]])) return false;
    if (reach_ == 0.0 && is_inner(triangles[face])) continue;
    const bool bad = meets(triangles[face], [&](std::uint32_t other) {
      return other >= side.pieces && other != face;
    });
    if (bad) return false;
  }
  return true;
}

} // namespace

bool is_sound(const CutAssembly& assembly, const CutSurface& surface, const Points& rest,
              double reach) {
  const CutCheck check(assembly, surface, rest, reach);
  return check.is_sound(true) && check.is_sound(false);
}

} // namespace nendo::deform
