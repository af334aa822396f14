#pragma once
// Adapts triangles to a shape: splits edges where the surface was stretched, collapses them where
// it was compressed, and flips them where this improves the triangles. After Stanculescu, Chaine
// and Cani, "Freestyle: Sculpting meshes with self-adaptive topology", 2011.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// An operation on the edge between two points. Points have the indices of the original mesh's
/// vertices, and each split appends a point in the middle; indices of removed points are not
/// reused.
struct EdgeOperation {
  enum class Kind : std::uint8_t {
    split,
    collapse, ///< `to` is merged into `from`, which does not move
    flip,
  };
  Kind kind = Kind::split;
  std::uint32_t from = 0, to = 0;
  friend bool operator==(const EdgeOperation&, const EdgeOperation&) = default;
};

struct RefinementLimits {
  std::size_t max_vertices = std::size_t{1} << 22; ///< no edge is split above this number
  std::size_t budget = 20000;                      ///< max number of splits and collapses
};

/// A refined mesh. The remaining vertices come first, with their order and bits.
struct Refinement {
  Mesh mesh;              ///< not deformed; all faces are triangles; with Mesh::detail
  Eigen::Matrix3Xf shape; ///< deformed position of each vertex, in block coordinates (BlockLayout)
  std::vector<EdgeOperation> operations; ///< in order of execution; empty: no change
};

/// Refines a mesh for its deformed shape. Only stretched or compressed regions change; Mesh::detail
/// has the target edge lengths. Creates no self-intersections, and keeps the Euler characteristic,
/// the borders between materials, names and texture islands, and the mesh's bounding box.
/// Deterministic to the bit.
class NENDO_API Refiner {
public:
  /// Error: bad_input, without the mesh's name, if the mesh is not finite, closed and two-manifold
  /// (closed_manifold.hpp). Allocates.
  static Result<void> check(const Mesh& mesh);
  /// Precomputes the data that depend only on the mesh. Error: that of check(). Allocates.
  static Result<Refiner> make(const Mesh& mesh);
  Refiner(Refiner&&) noexcept;
  Refiner& operator=(Refiner&&) noexcept;
  ~Refiner();

  /// Returns the number of edges of the shape that are too short, or too long unless the limit of
  /// vertices is reached. Allocates.
  std::size_t count_unfit(const BlockShape& shape, const BlockLayout& layout,
                          const RefinementLimits& limits) const;
  /// Allocates.
  Refinement refine(const BlockShape& shape, const BlockLayout& layout,
                    const RefinementLimits& limits) const;

private:
  struct Parts;
  explicit Refiner(std::unique_ptr<const Parts> parts);
  std::unique_ptr<const Parts> parts_;
};

/// Repeats the operations of a refinement on a mesh with the same faces: gives Refinement::mesh,
/// bit for bit. Error: bad_input (the mesh is not closed, or an operation is not applicable).
/// Allocates.
NENDO_API Result<Mesh> refined(const Mesh& mesh, std::span<const EdgeOperation> operations);

} // namespace nendo::deform
