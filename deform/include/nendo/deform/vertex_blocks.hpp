#pragma once
// Vertices for vector units: blocks of 64 that are neighbours in space, coordinates apart, in
// float. What a field does not reach is seen from a block's bounds, without reading the block.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

inline constexpr std::size_t block_size = 64;

struct alignas(64) VertexBlock {
  std::array<float, block_size> x, y, z;
};

/// The axis-aligned bounds of a block: lowest x, y, z, 0, and the negated highest x, y, z, 0, so
/// that the bounds of two are the lesser of each number.
struct alignas(32) BlockBounds {
  std::array<float, 8> sides;
};
BlockBounds bounds_of(const VertexBlock& block) noexcept;

/// A shape in blocks. Each block has a stamp; no two different contents in a process ever have the
/// same, so that a copy is brought up to date by copying only blocks that changed.
class BlockShape {
public:
  BlockShape() = default;
  explicit BlockShape(std::vector<VertexBlock> blocks);

  std::size_t block_count() const noexcept { return blocks_.size(); }
  const VertexBlock& operator[](std::size_t block) const noexcept { return blocks_[block]; }
  const VertexBlock* data() const noexcept { return blocks_.data(); }
  std::uint64_t stamp(std::size_t block) const noexcept { return stamps_[block]; }

  /// For writing: whoever changes a block must stamp it, with a new stamp for each change.
  VertexBlock* data() noexcept { return blocks_.data(); }
  void set_stamp(std::size_t block, std::uint64_t stamp) noexcept { stamps_[block] = stamp; }
  static std::uint64_t new_stamp() noexcept; ///< wait-free, from any thread

  /// Takes the block over if it differs. Both shapes must have it.
  void follow(const BlockShape& other, std::size_t block) noexcept {
    if (stamps_[block] == other.stamps_[block]) return;
    blocks_[block] = other.blocks_[block];
    stamps_[block] = other.stamps_[block];
  }
  /// Becomes equal to `other`. Allocates only where the sizes differ.
  void follow(const BlockShape& other);

private:
  std::vector<VertexBlock> blocks_;
  std::vector<std::uint64_t> stamps_;
};

/// Which vertex of a mesh stands where in the blocks (near ones together), and what their numbers
/// mean: vertex = origin + unit * coordinate. Blocks count from the middle of the model in a power
/// of two that is about its half size, so that a model far from zero loses nothing, and none is too
/// large for float. Immutable: any thread may use it.
class BlockLayout {
public:
  /// vertices: 3 by #vertices, kept as the original. Allocates.
  explicit BlockLayout(Points vertices);

  const Points& original() const noexcept { return original_; }
  const Eigen::Vector3d& origin() const noexcept { return origin_; }
  double unit() const noexcept { return unit_; }
  double diagonal() const noexcept { return diagonal_; } ///< of the original, in model units
  std::size_t vertex_count() const noexcept { return order_.size(); }
  std::size_t block_count() const noexcept { return (order_.size() + block_size - 1) / block_size; }
  /// The k-th vertex in block order is vertex order()[k] of the mesh.
  const std::vector<std::uint32_t>& order() const noexcept { return order_; }

  /// The original in blocks. What the last block has to spare repeats its last vertex.
  BlockShape pack() const;
  /// out = original + (shape - pack()): a coordinate that nothing moved is the original's, bit for
  /// bit. `out` is resized only if its size differs.
  void unpack(const BlockShape& shape, Points& out) const;

  /// The nearest place that a float holds in these coordinates. A field whose centres are such
  /// places is evaluated for exactly those centres that it was solved for.
  Eigen::Vector3d rounded(const Eigen::Vector3d& place) const noexcept;
  /// The same for a radius: of its inverse.
  double rounded_radius(double radius) const noexcept;

private:
  float packed(double coordinate, Eigen::Index axis) const noexcept;

  Points original_;
  Eigen::Vector3d origin_ = Eigen::Vector3d::Zero();
  double unit_ = 1.0;
  double diagonal_ = 0.0;
  std::vector<std::uint32_t> order_;
};

/// As large as a number in blocks may become: squares of it may overflow, sums may not.
inline constexpr double most_units = 1e35;

} // namespace nendo::deform
