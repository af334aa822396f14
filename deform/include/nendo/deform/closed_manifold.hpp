#pragma once
// Checks whether a surface is closed and two-manifold. Cutting and joining require this, because
// only such a surface has an interior. A fault has a position, so that the user can find and fix
// it.

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>

#include <nendo/base/api.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

enum class ManifoldFault {
  none,
  no_faces,
  few_corners,     ///< a face has fewer than three corners
  repeated_corner, ///< a face has a corner twice
  open_edge,       ///< an edge has a face on one side only
  crowded_edge,    ///< more than two faces meet at an edge
  turned_faces,    ///< two faces that share an edge have opposite orientations
  pinched_vertex,  ///< the faces around a vertex form more than one fan
};

/// The first fault, and the number of faults of its kind. Indices count from 0.
struct ManifoldCheck {
  ManifoldFault fault = ManifoldFault::none;
  std::size_t count = 0;
  std::uint32_t face = 0;         ///< the face with the fault
  std::uint32_t from = 0, to = 0; ///< vertices of the edge; equal if it is no edge
  explicit operator bool() const noexcept { return fault == ManifoldFault::none; }
};

/// Checks that each edge has exactly two faces, with consistent orientation, and that the faces
/// around each vertex form one fan. Vertices without a face are permitted. Faces are given as in
/// Mesh; each corner must be less than `vertices`. Checks connectivity only: a self-intersecting
/// surface may pass. Allocates.
NENDO_API ManifoldCheck check_closed_manifold(std::span<const std::uint32_t> face_starts,
                                              std::span<const std::uint32_t> face_corners,
                                              std::size_t vertices);
/// Checks a mesh. A face that visits a vertex twice, such as a face whose hole is connected by a
/// bridge, is replaced by its triangles (triangles.hpp), and is no fault.
NENDO_API ManifoldCheck check_closed_manifold(const Mesh& mesh);

/// Describes the fault in text to be appended to the mesh's name: "is open at the edge between (0,
/// 1, 2) and (0, 1, 3), and at 11 others". Empty if there is no fault.
NENDO_API std::string describe(const ManifoldCheck& check, const Mesh& mesh);

} // namespace nendo::deform
