#pragma once
// Clay that becomes thin: a neck parts, a wall gets a hole, and what comes as near fuses. In the
// manner of Stanculescu, Chaine and Cani, "Freestyle: Sculpting meshes with self-adaptive
// topology", 2011.

#include <cstddef>
#include <cstdint>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// How often each of these happened. A neck that parts, and parts that fuse, change the number of
/// parts or of handles; a hole makes a handle.
struct TopologyCounts {
  std::uint32_t parted = 0, holes = 0, fused = 0;
  std::uint32_t widened = 0; ///< holes and bridges that were there: that changes neither
  std::uint32_t all() const noexcept { return parted + holes + fused + widened; }
};

/// Closed and two-manifold, and nothing meets that did not meet before. Vertices that nothing
/// happened to keep their order, bits and looks.
struct ChangedTopology {
  Mesh mesh; ///< triangles; with Mesh::detail if there was any
  TopologyCounts counts;
};

/// Changes a mesh where it is thinner than its edges should be (Mesh::detail, or the mean of all
/// edges).
/// * Three edges that bound no triangle, and are together shorter than three edges should be, are
///   a neck. It is cut along them, and both ends are closed by a triangle.
/// * Two sheets that are nearer than 0.7 of an edge through a wall, or 0.15 through air, lose the
///   triangles where vertices face each other, and the rims are joined: a hole through a wall, or a
///   bridge through air.
/// Changes that would create tiny fragments or self-intersections are skipped. The same bits for
/// the same bits. Error text, to be appended to the model's name: bad_input (not finite, not
/// closed, or not two-manifold). Allocates.
NENDO_API Result<ChangedTopology> change_topology(const Mesh& mesh);

/// Returns how many places there are where change_topology() would try something, of a mesh that it
/// takes; 0 of others. Allocates.
NENDO_API std::size_t count_thin_places(const Mesh& mesh);

} // namespace nendo::deform
