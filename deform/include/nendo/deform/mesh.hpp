#pragma once
// A polygon mesh for deformation: vertices in a fixed order, and constant faces.

#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <nendo/base/api.hpp>
#include <nendo/deform/material.hpp>

namespace nendo::deform {

/// Points as columns: 3 by #points, in model units. A model unit is the unit of the file.
using Points = Eigen::Matrix3Xd;

/// Refinement data of a vertex (refinement.hpp).
struct VertexDetail {
  float edge = 0.0f;       ///< target edge length, model units
  bool is_refined = false; ///< the surface was refined here before
  friend bool operator==(const VertexDetail&, const VertexDetail&) = default;
};

struct Mesh {
  Points vertices;
  /// Face f has the corners face_corners[face_starts[f]] to face_corners[face_starts[f + 1] - 1].
  /// There are #faces + 1 entries.
  std::vector<std::uint32_t> face_starts{0};
  std::vector<std::uint32_t> face_corners; ///< vertex indices, 0-based
  /// Texture coordinates, 2 by #texcoords, and an index into them for each corner. Both are empty
  /// if there are none.
  Eigen::Matrix2Xd texcoords;
  std::vector<std::uint32_t> corner_texcoords;
  Appearance look; ///< materials, colours and names
  /// One per vertex of a refined mesh, otherwise empty. Not stored in files.
  std::vector<VertexDetail> detail;
  /// The origin of `vertices` in file coordinates (offset.hpp). A vertex has the file coordinates
  /// offset + vertex.
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();

  std::size_t face_count() const noexcept { return face_starts.size() - 1; }
  /// Returns the vertices at the face's corners.
  std::span<const std::uint32_t> corners_of(std::size_t face) const noexcept {
    return std::span(face_corners)
        .subspan(face_starts[face], face_starts[face + 1] - face_starts[face]);
  }
  std::size_t vertex_count() const noexcept { return static_cast<std::size_t>(vertices.cols()); }
};

struct Box {
  Eigen::Vector3d lowest, highest; ///< lowest[0] > highest[0] if the box is empty

  bool contains(const Eigen::Vector3d& place) const noexcept {
    return (place.array() >= lowest.array()).all() && (place.array() <= highest.array()).all();
  }
  friend bool operator==(const Box&, const Box&) = default;
};

/// Returns the axis-aligned bounding box of the points that are finite.
NENDO_API Box finite_box_of(const Points& points) noexcept;

/// Returns the axis-aligned bounding box of the finite vertices of faces, or of all finite vertices
/// if there is no face. Models are measured by their faces only, because files may have stray
/// vertices far from them, for example vertices of ignored lines.
NENDO_API Box box_of_faces(const Mesh& mesh) noexcept;

/// Returns the vertices without a face. Empty if there is no face, because the mesh is then a point
/// cloud.
NENDO_API std::vector<std::uint32_t> stray_vertices(const Mesh& mesh);

/// Returns the faces and their vertices, without appearance and texture coordinates; nullopt if
/// there is no stray vertex.
NENDO_API std::optional<Mesh> without_stray_vertices(const Mesh& mesh);

/// Returns the length of the diagonal of the axis-aligned bounding box, in model units; 0 if there
/// are no points.
NENDO_API double diagonal_of(const Points& points) noexcept;

/// Returns a warning if a mesh has no faces, or all its vertices are at one position, though it can
/// be deformed. The text is to be appended to the mesh's name; empty if there is no warning.
NENDO_API std::string_view warning_about(const Mesh& mesh) noexcept;

/// Returns for each vertex the sum of twice the area vectors of its faces, 3 by #vertices, in
/// squares of `unit`, a length in model units. `places` are the vertices, 3 by #vertices, and
/// `mesh` has the faces. With a unit near the model's size, squares are finite for any model.
/// Allocates.
NENDO_API Points vertex_areas(const Mesh& mesh, const Points& places, double unit);

/// Returns the unit normals of the vertices, 3 by #vertices: area-weighted means of the face
/// normals. A vertex without a face of positive area has a zero normal.
NENDO_API Points vertex_normals(const Mesh& mesh);

} // namespace nendo::deform
