#pragma once
// A mesh's faces as triangles, the same ones for everything that needs triangles: pictures,
// windows, hands, cuts, joins and exports.
//
// - A face of three corners is that triangle, and one of fewer corners gives none.
// - A face becomes a fan about its first corner wherever that is right: all triangles of the fan
//   face the way of the face. So it is for convex faces.
// - Other faces are cut by clipping ears, in the plane of the face's area vector (Newell's). Faces
//   may be concave, have holes by bridges (a vertex twice), touch themselves, or be warped. All
//   decisions are exact. A face that crosses itself, or without area, gets triangles that overlap.
// - A face of n corners gives n - 2 triangles. Those that would have a vertex twice are left out,
//   which only faces with a vertex twice can have.
//
// One set of places decides, so that triangles do not change while hands shape a model: those in
// Mesh::vertices, which in a run are the model version's rest. Whoever puts other places into a
// mesh says which places decide.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Three corners or vertices, counter-clockwise seen from where the face faces to.
using Triangle = std::array<std::uint32_t, 3>;

class NENDO_API FaceTriangles {
public:
  /// The places of the mesh's vertices decide. The mesh must outlive this.
  explicit FaceTriangles(const Mesh& mesh) : FaceTriangles(mesh, mesh.vertices) {}
  /// Other places of the vertices decide; they must outlive this. Vertices of faces that are
  /// asked for must be among them.
  FaceTriangles(const Mesh& mesh, const Points& places);
  ~FaceTriangles();
  FaceTriangles(const FaceTriangles&) = delete;
  FaceTriangles& operator=(const FaceTriangles&) = delete;

  /// Returns the triangles of a face. Their corners are places in Mesh::face_corners and in
  /// Mesh::corner_texcoords. They are valid until the next call. Seldom allocates.
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

/// Calls visit(face, Triangle) with the corners of every triangle: places in Mesh::face_corners.
template <class Visit>
void for_each_face_triangle(const Mesh& mesh, Visit visit) {
  FaceTriangles triangles(mesh);
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (const Triangle& corners : triangles.of(face))
      visit(face, corners);
}

/// Calls visit(Triangle) with the vertices of every triangle. `places` decide.
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

/// Returns the mesh with some faces, one entry for each, replaced by their triangles, about which
/// `places` decide. Their materials, names and texture coordinates follow.
NENDO_API Mesh with_split_faces(const Mesh& mesh, const Points& places,
                                const std::vector<bool>& is_split);

/// Returns the mesh so that the places of its own vertices give the triangles that `rest` gives:
/// each face that they would cut in another way is replaced by its triangles. `rest` has the places
/// of the first vertices; faces with later vertices stay. For a shape that becomes a model.
NENDO_API Mesh with_triangles_of(Mesh mesh, const Points& rest);

/// Returns the model with its vertices in other places, with the triangles that it has.
NENDO_API Mesh in_shape(const Mesh& model, Points places);

} // namespace nendo::deform
