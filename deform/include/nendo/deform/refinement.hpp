#pragma once
// Triangles that follow a shape: where a surface was stretched its edges are split, where it was
// crowded they are collapsed, and edges are flipped where that makes triangles fairer. In the
// manner of Stanculescu, Chaine and Cani, "Freestyle: Sculpting meshes with self-adaptive
// topology", 2011.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

/// What is done to the edge between two points. Points are numbered as the vertices of the mesh
/// before, and each split appends one in the middle; numbers of points that are gone are not used
/// again.
struct EdgeOperation {
  enum class Kind : std::uint8_t {
    split,
    collapse, ///< `to` goes into `from`, which stays in its place
    flip,
  };
  Kind kind = Kind::split;
  std::uint32_t from = 0, to = 0;
  friend bool operator==(const EdgeOperation&, const EdgeOperation&) = default;
};

struct RefinementLimits {
  std::size_t max_vertices = std::size_t{1} << 22; ///< no edge is split beyond it
  std::size_t budget = 20000;                      ///< splits and collapses
};

/// A refined mesh. Vertices that stay come first, in their order and with their bits.
struct Refinement {
  Mesh mesh;              ///< as it is before the hands; all faces are triangles; with Mesh::detail
  Eigen::Matrix3Xf shape; ///< where each vertex is, in the numbers of the blocks (BlockLayout)
  std::vector<EdgeOperation> operations; ///< in their order; empty: there was nothing to do
};

/// Refines a mesh for the shape that it has. Only what the shape stretches or presses is touched:
/// edges there should be as long as Mesh::detail says. It never makes a self-intersection, keeps
/// the Euler characteristic and the borders between materials, names and texture islands, and lets
/// the mesh's bounding box be. The same bits for the same bits.
class NENDO_API Refiner {
public:
  /// bad_input, without the mesh's name, if it is not finite, closed and two-manifold
  /// (closed_manifold.hpp). Allocates.
  static Result<void> check(const Mesh& mesh);
  /// Makes ready what needs only the mesh. Error: that of check(). Allocates.
  static Result<Refiner> make(const Mesh& mesh);
  Refiner(Refiner&&) noexcept;
  Refiner& operator=(Refiner&&) noexcept;
  ~Refiner();

  /// Returns how many edges of that shape of the mesh are too short, or too long, unless the
  /// limit of vertices is reached. Allocates.
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

/// Does to a mesh what was done to one of the same faces: Refinement::mesh, to the last bit.
/// bad_input: it is not closed, or an operation cannot be done to it. Allocates.
NENDO_API Result<Mesh> refined(const Mesh& mesh, std::span<const EdgeOperation> operations);

/// Returns a refinement's shape in blocks of its mesh's layout. Allocates.
NENDO_API BlockShape shape_in_blocks(const Eigen::Matrix3Xf& shape, const BlockLayout& layout);

} // namespace nendo::deform
