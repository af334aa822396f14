#pragma once
// Keeps the volume of a closed surface: what is pressed in comes out where nothing touches. Each
// block knows its part of the volume, which is computed anew only where vertices have moved.

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <nendo/deform/vertex_blocks.hpp>

#include "block_evaluator.hpp"
#include "clay/contact_search.hpp"
#include "rows_by_key.hpp"

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
  /// The next volume() then measures all anew. Between, only what has changed is measured, and the
  /// directions in which the shape swells are, to rounding, those of the calls before.
  void forget() noexcept;
  /// Somebody has changed that block, and its stamp has stayed.
  void read_again(std::size_t block) noexcept {
    if (is_closed_) stamps_[block] = 0;
  }
  /// Moves what is free along its normals, so that the volume grows by `missing`, or by what
  /// GiveBack::most permits. Call volume() first. Returns how much it grew, to second order. Does
  /// not allocate.
  double give_back(BoundedShape& shape, ContactSearch& search, double missing,
                   const GiveBack& how) noexcept;

private:
  void build_fans(const BlockLayout& layout, std::span<const std::uint32_t> corners);
  void build_neighbours(std::size_t blocks);
  std::size_t end_of(std::size_t block) const noexcept {
    return std::min(vertices_, (block + 1) * block_size);
  }
  bool has_changed(const BoundedShape& shape, std::size_t block) const noexcept;
  void read(const BoundedShape& shape, std::size_t block) noexcept;
  double measure(std::size_t place) noexcept;
  void measure_block(std::size_t block) noexcept;
  void weigh(const BoundedShape& shape, ContactSearch& search, const GiveBack& how) noexcept;
  void weigh_around(const BoundedShape& shape, std::size_t block, const GiveBack& how) noexcept;
  void sum_rates() noexcept;
  double distance_for(double missing, double most) const noexcept;
  void move(BoundedShape& shape, float far) noexcept;

  std::size_t vertices_;
  bool is_closed_ = false;
  RowsByKey<std::uint32_t> fans_;       ///< of each place: its neighbours in their order
  RowsByKey<std::uint32_t> neighbours_; ///< of each block, with itself
  std::vector<std::uint64_t> stamps_;   ///< of the blocks when they were measured
  std::vector<double> volumes_;         ///< one a block
  std::vector<std::uint8_t> is_free_;   ///< one a block: some weight is not 0
  // One a place, with a fourth number, so that one load takes a whole neighbour.
  std::vector<Eigen::Vector4f> points_;
  std::vector<Eigen::Vector4f> normals_; ///< the volume's derivative by each vertex
  std::vector<Eigen::Vector4f> directions_;
  std::vector<Eigen::Vector4f> fairing_; ///< the way to the neighbours' middle; an inverse edge
  std::vector<float> rates_;             ///< by which the volume grows with each one's distance
  std::vector<float> curvatures_;        ///< mean ones
  std::vector<float> weights_;
  double rate_ = 0.0; ///< by which the volume grows with the distance
  double bend_ = 0.0; ///< and with its square
};

} // namespace nendo::deform
