#pragma once
// Chooses the places at which a body pushes: the deepest vertex of each cell of space, one a part,
// and of those only such as do not crowd.

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "simd/contact_kernels.hpp"

namespace nendo::deform {

struct ContactPoint {
  std::uint32_t place = 0; ///< of the vertex, in block order
  std::uint32_t body = 0;
  std::uint32_t part = 0;
  double depth = 0.0; ///< negative outside
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< out of the body
};

/// Nothing depends on an order of memory or of a hash, so that a replay chooses the same.
class ContactPoints {
public:
  /// Allocates for so many chosen points.
  explicit ContactPoints(std::size_t most);

  /// Begins a choice with cells of this size.
  void clear(double cell) noexcept;
  /// Returns the cells, for nearest_of_cells().
  const SpaceCells& cells() const noexcept { return cells_; }
  /// Offers a vertex. If it is the deepest yet of its cell and part, returns the point that the
  /// caller sets to it, with a normal of any length; otherwise null. The first of those that are
  /// equally deep stays. When the table is full, vertices of new cells are left out; the next pass
  /// meets them.
  ContactPoint* offer(const Eigen::Vector3f& at, std::uint32_t part, double depth) noexcept;
  /// Returns the deepest, none nearer than `apart` to a deeper one that pushes into nearly the same
  /// direction; at most as many as there is room for.
  std::span<const ContactPoint> choose(double apart) noexcept;

private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t round = 0; ///< of the choice to which it belongs
    std::uint32_t point = 0;
  };
  /// Those chosen so far, as vectors take them.
  struct Chosen {
    std::vector<float> x, y, z, normal_x, normal_y, normal_z;
  };
  bool is_crowded(const ContactPoint& point, std::size_t chosen, float squared) const noexcept;
  void note_chosen(const ContactPoint& point, std::size_t at) noexcept;

  SpaceCells cells_{};
  std::uint32_t round_ = 0;
  Chosen chosen_;
  std::vector<Slot> slots_;          ///< an open hash table
  std::vector<ContactPoint> points_; ///< one a cell
  std::size_t most_;
};

} // namespace nendo::deform
