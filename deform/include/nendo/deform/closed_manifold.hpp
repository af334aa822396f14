#pragma once
// Whether a surface is closed and two-manifold, which cutting and joining need: only then does it
// have an inside. What is wrong is said with its place, so that a user can find and fix it.

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
  turned_faces,    ///< two faces that share an edge face opposite ways
  pinched_vertex,  ///< faces touch at a vertex only: around it they form more than one fan
};

/// The first fault, and how many of its kind there are. Faces and vertices count from 0.
struct ManifoldCheck {
  ManifoldFault fault = ManifoldFault::none;
  std::size_t count = 0;
  std::uint32_t face = 0;         ///< where it is
  std::uint32_t from = 0, to = 0; ///< the edge; the same vertex twice, if it is no edge
  explicit operator bool() const noexcept { return fault == ManifoldFault::none; }
};

/// Checks that each edge has exactly one face on each side, facing the same way, and that the faces
/// around each vertex form one fan. Vertices without a face are no fault. Faces are given as in
/// Mesh; each corner must be below `vertices`. It looks at connections alone: a surface that cuts
/// through itself may pass. Allocates.
NENDO_API ManifoldCheck check_closed_manifold(std::span<const std::uint32_t> face_starts,
                                              std::span<const std::uint32_t> face_corners,
                                              std::size_t vertices);
/// The same of a mesh. A face that goes through a vertex twice, as one with a hole by a bridge, is
/// taken as its triangles (triangles.hpp); then it is no fault.
NENDO_API ManifoldCheck check_closed_manifold(const Mesh& mesh);

/// Returns the fault in words that go behind the mesh's name: "is open at the edge between (0, 1,
/// 2) and (0, 1, 3), and at 11 others". Empty if there is no fault.
NENDO_API std::string describe(const ManifoldCheck& check, const Mesh& mesh);

} // namespace nendo::deform
