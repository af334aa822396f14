#pragma once
// The places at which a body pushes: the deepest vertex of each cell of space, one per part, and of
// those only such as do not crowd; and the pressure that each vertex remembers.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include <nendo/deform/vertex_blocks.hpp>

#include "simd/contact_kernels.hpp"

namespace nendo::deform {

struct ContactPoint {
  std::uint32_t place = 0; ///< the vertex' place in block order
  std::uint32_t body = 0;
  std::uint32_t part = 0;
  double depth = 0.0; ///< negative outside
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< out of the body
};

/// A vertex near a body, as a search has found it. It is small, because many are kept.
struct NearVertex {
  std::uint32_t place = 0;
  std::uint32_t body = 0;
  std::uint32_t part = 0;
  float depth = 0.0F; ///< negative outside
  Eigen::Vector3f at = Eigen::Vector3f::Zero();
  Eigen::Vector3f centre = Eigen::Vector3f::Zero(); ///< centre of the part's nearest ball
};

/// Returns the normal of a part at a place, away from the centre of its nearest ball.
inline Eigen::Vector3d normal_from(const Eigen::Vector3f& centre,
                                   const Eigen::Vector3d& place) noexcept {
  const Eigen::Vector3d way = place - centre.cast<double>();
  const double length = way.norm();
  return length > 0.0 ? Eigen::Vector3d(way / length) : Eigen::Vector3d::UnitZ();
}

/// Nothing depends on an order of memory or of a hash, so that a replay chooses the same.
class ContactPoints {
public:
  /// Allocates for so many chosen points.
  explicit ContactPoints(std::size_t most);

  /// Begins a choice with cells of this size.
  void clear(double cell) noexcept;
  /// Returns the cells, for nearest_of_cells().
  const SpaceCells& cells() const noexcept { return cells_; }
  /// Keeps the vertex if it is the deepest yet of its cell and part. The first of those that are
  /// equally deep stays. When the table is full, vertices of new cells are left out; the next pass
  /// meets them. Not after choose().
  void offer(const NearVertex& vertex) noexcept;
  /// Returns the deepest, none nearer than `apart` to a deeper one that pushes into nearly the same
  /// direction; at most as many as were allocated. Until the next clear() they stay the same.
  std::span<const ContactPoint> choose(double apart) noexcept;

private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t round = 0; ///< the choice to which it belongs
    std::uint32_t vertex = 0;
  };

  /// Adds a place, unless a chosen one is nearer than the root of `squared` whose normal is within
  /// 60 degrees of its normal. Returns whether it did.
  bool add_place(const Eigen::Vector3f& at, const Eigen::Vector3f& normal, float squared) noexcept;

  SpaceCells cells_{};
  std::uint32_t round_ = 0;
  std::vector<Slot> slots_;          ///< an open hash table
  std::vector<NearVertex> vertices_; ///< one per cell
  /// Coordinates of the chosen places and their normals; beyond the last, far away.
  std::array<std::vector<float>, 6> rows_;
  std::vector<ContactPoint> chosen_;
  bool is_chosen_ = false; ///< since clear()
};

/// The pressure of a body that each vertex remembers. Once the clay fits a hand, nothing is deep
/// any more, and without a memory the friction would end. Lengths are in a layout's coordinates.
class ContactLoad {
public:
  /// Allocates for one body. `most` is the largest load: how far the clay springs back.
  ContactLoad(std::size_t blocks, double most);

  /// Takes note of the distances of a block's vertices.
  void press(std::size_t block, const NearestLanes& nearest) noexcept;
  /// Ends a round of press(): blocks that were not pressed have no load any more.
  void end_round() noexcept;
  void clear() noexcept;

  /// Returns the load of a vertex at that distance: what it was pressed by, less the gap.
  double at(std::uint32_t place, double distance) const noexcept;
  std::uint8_t& slips(std::uint32_t place) noexcept { return slips_[place]; }
  /// Returns whether the last round left any load.
  bool is_any() const noexcept { return was_any_; }

private:
  void clear(std::size_t block) noexcept;

  float max_;
  std::uint64_t round_ = 1;
  bool is_any_ = false, was_any_ = false;
  std::vector<std::uint64_t> rounds_; ///< the last round with a load for each block; 0: none
  std::vector<float> pressed_;
  std::vector<std::uint8_t> slips_;
};

} // namespace nendo::deform
