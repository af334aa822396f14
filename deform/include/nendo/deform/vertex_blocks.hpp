#pragma once
// Vertices in a layout for vector instructions: floats in blocks of 64 spatial neighbours, with
// separate arrays of x, y and z. A block's bounds show whether a field reaches it.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

inline constexpr std::size_t block_size = 64;

/// Returns the number of blocks for this number of vertices; the last block may be partly filled.
constexpr std::size_t block_count_of(std::size_t vertices) noexcept {
  return (vertices + block_size - 1) / block_size;
}

struct alignas(64) VertexBlock {
  std::array<float, block_size> x, y, z;
};

/// The axis-aligned bounds of a block: lowest x, y, z, 0, and the negated highest x, y, z, 0, so
/// that the bounds of two blocks are the element-wise minimum.
struct alignas(32) BlockBounds {
  std::array<float, 8> sides;
};
NENDO_API BlockBounds bounds_of(const VertexBlock& block) noexcept;

/// A shape in blocks. Each block has a stamp. Different contents never have the same stamp in a
/// process, so a copy is brought up to date by copying only the blocks that changed.
class NENDO_API BlockShape {
public:
  BlockShape() = default;
  explicit BlockShape(std::vector<VertexBlock> blocks);

  std::size_t block_count() const noexcept { return blocks_.size(); }
  const VertexBlock& operator[](std::size_t block) const noexcept { return blocks_[block]; }
  const VertexBlock* data() const noexcept { return blocks_.data(); }
  std::uint64_t stamp(std::size_t block) const noexcept { return stamps_[block]; }

  /// Gives access for writing. Code that changes a block must set a new stamp for each change.
  VertexBlock* data() noexcept { return blocks_.data(); }
  void set_stamp(std::size_t block, std::uint64_t stamp) noexcept { stamps_[block] = stamp; }
  static std::uint64_t new_stamp() noexcept; ///< wait-free, thread-safe

  /// Copies the block of `other` if its stamp differs. Both shapes must have that block.
  void follow(const BlockShape& other, std::size_t block) noexcept {
    if (stamps_[block] == other.stamps_[block]) return;
    blocks_[block] = other.blocks_[block];
    stamps_[block] = other.stamps_[block];
  }
  /// Copies those blocks of `other` whose stamps differ. Allocates only if the sizes differ.
  void follow(const BlockShape& other);

private:
  std::vector<VertexBlock> blocks_;
  std::vector<std::uint64_t> stamps_;
};

/// Returns the vertex in that lane of a block.
inline Eigen::Vector3f vertex_in(const VertexBlock& block, std::size_t lane) noexcept {
  return {block.x[lane], block.y[lane], block.z[lane]};
}
inline void set_vertex(VertexBlock& block, std::size_t lane, const Eigen::Vector3f& to) noexcept {
  block.x[lane] = to.x();
  block.y[lane] = to.y();
  block.z[lane] = to.z();
}
/// Returns the vertex at this index in block order.
inline Eigen::Vector3f vertex_at(const BlockShape& shape, std::size_t place) noexcept {
  return vertex_in(shape[place / block_size], place % block_size);
}

/// The index of each vertex of a mesh in the blocks, and the block coordinates: vertex = origin +
/// unit * coordinate. The origin is the centre of the model, and the unit a power of two near half
/// its size, so that float is precise enough for models of any size and position. Immutable:
/// thread-safe.
class NENDO_API BlockLayout {
public:
  /// vertices: 3 by #vertices, kept as the original. Allocates.
  explicit BlockLayout(Points vertices);

  const Points& original() const noexcept { return original_; }
  const Eigen::Vector3d& origin() const noexcept { return origin_; }
  double unit() const noexcept { return unit_; }
  double diagonal() const noexcept {
    return diagonal_;
  } ///< box diagonal of the original, model units
  std::size_t vertex_count() const noexcept { return order_.size(); }
  std::size_t block_count() const noexcept { return block_count_of(order_.size()); }
  /// The k-th vertex in block order is vertex order()[k] of the mesh.
  const std::vector<std::uint32_t>& order() const noexcept { return order_; }

  /// Returns the index in block order of each vertex of the mesh: the inverse of order().
  std::vector<std::uint32_t> places() const;

  /// Returns the original in blocks. The rest of the last block repeats its last vertex. Allocates.
  BlockShape pack() const { return pack(original_); }
  /// Returns other positions of these vertices in blocks. unpack() inverts this, up to rounding.
  BlockShape pack(const Points& places) const;
  /// Computes out = origin + unit * shape, 3 by #vertices; but a coordinate that did not move is
  /// the original's, bit for bit. So faces that do not intersect in the blocks do not intersect in
  /// `out`, except at unmoved coordinates. `out` is resized only if its size differs.
  void unpack(const BlockShape& shape, Points& out) const;

  /// Returns the nearest position that float block coordinates can represent. A field must be
  /// solved for such centres, so that the evaluation in float uses exactly the same ones.
  Eigen::Vector3d rounded(const Eigen::Vector3d& place) const noexcept;
  /// Returns the nearest radius whose inverse a float can represent.
  double rounded_radius(double radius) const noexcept;

private:
  float packed(double coordinate, Eigen::Index axis) const noexcept;

  Points original_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double unit_ = 1.0;
  double diagonal_ = 0.0;
  std::vector<std::uint32_t> order_;
};

/// Max absolute value of a block coordinate. Sums of such numbers do not overflow; squares may.
inline constexpr double max_units = 1e35;

/// Returns a refinement's shape in blocks of its mesh's layout. Allocates.
NENDO_API BlockShape shape_in_blocks(const Eigen::Matrix3Xf& shape, const BlockLayout& layout);

} // namespace nendo::deform
