#pragma once
// Topology changes of thin clay: a neck splits, a wall gets a hole, and close surfaces fuse. After
// Stanculescu, Chaine and Cani, "Freestyle: Sculpting meshes with self-adaptive topology", 2011.

#include <cstddef>
#include <cstdint>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

/// Number of changes of each kind. Splits and fusions change the number of parts or of handles; a
/// hole adds a handle.
struct TopologyCounts {
  std::uint32_t parted = 0, holes = 0, fused = 0;
  std::uint32_t widened = 0; ///< existing holes and bridges that grew, which changes neither number
  std::uint32_t all() const noexcept { return parted + holes + fused + widened; }
};

/// A closed two-manifold result without new self-intersections. Unchanged vertices keep their
/// order, bits and appearance.
struct ChangedTopology {
  Mesh mesh; ///< triangles; with Mesh::detail if the input had it
  TopologyCounts counts;
};

/// Changes a mesh where it is thinner than the target edge length (Mesh::detail, or the mean edge
/// length).
/// * A neck is a loop of three edges that bounds no triangle, and is shorter than three target edge
///   lengths. It is cut along them, and a triangle closes each end.
/// * Two sheets closer than 0.7 edge lengths through a wall, or 0.15 through air, lose the
///   triangles at opposite vertices, and the rims are joined: a hole through a wall, or a bridge
///   through air.
/// Changes that would create tiny fragments or self-intersections are skipped. Deterministic to the
/// bit. Error text, to be appended to the model's name: bad_input (not finite, not closed, or not
/// two-manifold). Allocates.
NENDO_API Result<ChangedTopology> change_topology(const Mesh& mesh);

/// Returns the number of positions where change_topology() would attempt a change; 0 for a mesh
/// that it rejects. Allocates.
NENDO_API std::size_t count_thin_places(const Mesh& mesh);

} // namespace nendo::deform
