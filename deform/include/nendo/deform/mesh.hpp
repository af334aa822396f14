#pragma once
// A polygon mesh as the deformation needs it: vertices in a fixed order, faces that are carried
// along unchanged.

#include <cstdint>
#include <vector>

#include <Eigen/Core>

namespace nendo::deform {

/// 3 by #points, in model units (whatever unit the file was in).
using Points = Eigen::Matrix3Xd;

struct Mesh {
  Points vertices;
  /// Face f has the corners face_corners[face_starts[f]] to face_corners[face_starts[f + 1] - 1];
  /// #faces + 1 long.
  std::vector<std::uint32_t> face_starts{0};
  std::vector<std::uint32_t> face_corners; ///< vertex indices, 0-based
  /// Texture coordinates (2 by #texcoords) and, a corner each, indices into them; both empty if
  /// there are none.
  Eigen::Matrix2Xd texcoords;
  std::vector<std::uint32_t> corner_texcoords;

  std::size_t face_count() const noexcept { return face_starts.size() - 1; }
};

struct Box {
  Eigen::Vector3d lowest, highest; ///< lowest[0] > highest[0] if there is nothing in it
};

/// The axis-aligned bounding box of the points that are finite.
Box finite_box_of(const Points& points) noexcept;

/// Length of the diagonal of the axis-aligned bounding box; 0 for no points.
double diagonal_of(const Points& points) noexcept;

/// 3 by #vertices, unit length, area-weighted; zero where a vertex has no face of any area.
Points vertex_normals(const Mesh& mesh);

} // namespace nendo::deform
