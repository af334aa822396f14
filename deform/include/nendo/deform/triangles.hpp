#pragma once
// Triangulates a mesh's faces, identically for all code that needs triangles: pictures, windows,
// hands, cuts, joins and exports.
//
// - A face of three corners is that triangle, and one of fewer corners gives none.
// - A face becomes a fan around its first corner if all triangles of the fan have the face's
//   orientation, as for convex faces.
// - Other faces are triangulated by ear clipping, in the plane of the face's area vector
//   (Newell's). Faces may be concave, have holes connected by bridges (a vertex twice), touch
//   themselves, or be non-planar. All predicates are exact. A face that intersects itself, or has
//   no area, gets overlapping triangles.
// - A face of n corners gives n - 2 triangles, without those that repeat a vertex, which occur only
//   if the face repeats a vertex.
//
// One set of positions determines the triangles, so that they do not change while hands shape a
// model: Mesh::vertices, which in a run are the rest shape of the model version. Code that puts
// other positions into a mesh must pass the positions that determine the triangles.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Three corners or vertices, counter-clockwise seen from the front.
using Triangle = std::array<std::uint32_t, 3>;

class NENDO_API FaceTriangles {
public:
  /// The mesh's vertices determine the triangles. The mesh must outlive this object.
  explicit FaceTriangles(const Mesh& mesh) : FaceTriangles(mesh, mesh.vertices) {}
  /// Other vertex positions determine the triangles. They must outlive this object, and include the
  /// vertices of all requested faces.
  FaceTriangles(const Mesh& mesh, const Points& places);
  ~FaceTriangles();
  FaceTriangles(const FaceTriangles&) = delete;
  FaceTriangles& operator=(const FaceTriangles&) = delete;

  /// Returns the triangles of a face. Their corners are indices into Mesh::face_corners and
  /// Mesh::corner_texcoords. The span is valid until the next call. Rarely allocates.
  std::span<const Triangle> of(std::size_t face) {
    const std::uint32_t begin = mesh_.face_starts[face];
    const std::uint32_t count = mesh_.face_starts[face + 1] - begin;
    if (count != 3) return of_polygon(begin, count);
    one_ = {begin, begin + 1, begin + 2};
    return {&one_, 1};
  }
  /// Returns whether no corner of the face is reflex. Faces without area count as convex.
  bool is_convex(std::size_t face);

private:
  struct Parts;
  std::span<const Triangle> of_polygon(std::uint32_t begin, std::uint32_t count);
  bool take(std::uint32_t begin, std::uint32_t count);

  const Mesh& mesh_;
  const Points& places_;
  Triangle one_{};
  std::vector<Triangle> some_;
  std::unique_ptr<Parts> parts_;
};

/// Calls visit(face, Triangle) with the corners of every triangle: indices into Mesh::face_corners.
template <class Visit>
void for_each_face_triangle(const Mesh& mesh, Visit visit) {
  FaceTriangles triangles(mesh);
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (const Triangle& corners : triangles.of(face))
      visit(face, corners);
}

/// Calls visit(Triangle) with the vertices of every triangle. `places` determine the triangles.
template <class Visit>
void for_each_triangle(const Mesh& mesh, const Points& places, Visit visit) {
  FaceTriangles triangles(mesh, places);
  const std::vector<std::uint32_t>& vertex = mesh.face_corners;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (const auto& [a, b, c] : triangles.of(face))
      visit(Triangle{vertex[a], vertex[b], vertex[c]});
}

template <class Visit>
void for_each_triangle(const Mesh& mesh, Visit visit) {
  for_each_triangle(mesh, mesh.vertices, visit);
}

/// Returns the vertex indices of all triangles, three for each.
NENDO_API std::vector<std::uint32_t> corners_of_triangles(const Mesh& mesh);

/// Returns the mesh with the faces of true entries of `is_split` replaced by their triangles, which
/// `places` determine. The triangles keep materials, names and texture coordinates.
NENDO_API Mesh with_split_faces(const Mesh& mesh, const Points& places,
                                const std::vector<bool>& is_split);

/// Returns the mesh such that its own vertices determine the same triangles as `rest`: each face
/// whose triangles would differ is replaced by its triangles. `rest` has the positions of the first
/// vertices; faces with later vertices are unchanged. For a shape that becomes a model.
NENDO_API Mesh with_triangles_of(Mesh mesh, const Points& rest);

/// Returns the model with other vertex positions and the same triangles.
NENDO_API Mesh in_shape(const Mesh& model, Points places);

} // namespace nendo::deform
