#pragma once
// Keeps the volume of a closed surface: what is pressed in comes out where nothing touches. Each
// block knows its part of the volume, which is computed anew only where vertices have moved.

#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/vertex_blocks.hpp>

#include "block_evaluator.hpp"
#include "clay/contact_search.hpp"

namespace nendo::deform {

/// Lengths are in a layout's coordinates.
struct GiveBack {
  double near;           ///< from a body's surface to here the surface is less and less held
  double most;           ///< a vertex goes in one call
  const BoxGate* around; ///< where the bodies touch; null: everything is to swell alike
  double reach;          ///< from this box to here it swells less and less
};

class VolumeKeeper {
public:
  /// Allocates. `triangles` are vertices of the mesh.
  VolumeKeeper(const BlockLayout& layout, std::span<const std::uint32_t> triangles);

  /// Tells whether the triangles are a closed, oriented surface: each edge is run along once in
  /// each direction. Otherwise there is no volume, and the other functions must not be called.
  bool is_closed() const noexcept { return is_closed_; }
  /// Returns the volume of that shape. Does not allocate.
  double volume(const BoundedShape& shape) noexcept;
  /// Moves what is free along its normals, so that the volume grows by `missing`, or by what
  /// GiveBack::most permits. Call volume() first. Returns how much it grew, to first order. Does
  /// not allocate.
  double give_back(BoundedShape& shape, ContactSearch& search, double missing,
                   const GiveBack& how) noexcept;

private:
  struct Pair {
    std::uint32_t second, third; ///< of a triangle that begins at the vertex
  };
  void build_rings(const BlockLayout& layout, std::span<const std::uint32_t> corners);
  void build_neighbours(std::size_t blocks);
  bool has_changed(const BoundedShape& shape, std::size_t block) const noexcept;
  void measure(const BoundedShape& shape, std::size_t block) noexcept;
  void weigh(const BoundedShape& shape, ContactSearch& search, const GiveBack& how) noexcept;
  template <class Visit>
  void each_free(const Visit& visit) const;
  double direct() noexcept;
  void scale_moves(const BoundedShape& shape, float far) noexcept;
  void apply_moves(BoundedShape& shape) noexcept;
  Eigen::Vector3f direction_at(std::size_t place) const noexcept;
  Eigen::Vector3f mean_round(const BoundedShape& shape, std::size_t place) const noexcept;

  std::size_t vertices_;
  bool is_closed_ = false;
  std::vector<std::uint32_t> starts_; ///< of each place's pairs
  std::vector<Pair> pairs_;
  std::vector<std::uint32_t> neighbour_starts_; ///< of each block's neighbours, with itself
  std::vector<std::uint32_t> neighbours_;
  std::vector<std::uint64_t> stamps_; ///< of the blocks when they were measured
  std::vector<double> volumes_;       ///< one a block
  std::vector<VertexBlock> normals_;  ///< the volume's derivative by each vertex
  std::vector<VertexBlock> moves_;
  std::vector<float> weights_;        ///< one a place
  std::vector<std::uint8_t> is_free_; ///< one a block: some weight is not 0
};

} // namespace nendo::deform
