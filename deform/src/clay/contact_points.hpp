#pragma once
// Chooses the places at which a body pushes: the deepest vertex of each cell of space, one a part,
// and of those only such as do not crowd.

#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

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
  /// Offers a vertex. The first of those that are equally deep stays. When the table is full,
  /// vertices of new cells are left out; the next pass meets them.
  void offer(const ContactPoint& point) noexcept;
  /// Returns the deepest, none nearer than `apart` to a deeper one that pushes into nearly the same
  /// direction; at most as many as there is room for.
  std::span<const ContactPoint> choose(double apart) noexcept;

private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t round = 0; ///< of the choice to which it belongs
    std::uint32_t point = 0;
  };
  bool is_crowded(const ContactPoint& point, std::size_t chosen, double apart) const noexcept;

  double per_cell_ = 1.0;
  std::uint32_t round_ = 0;
  std::vector<Slot> slots_;          ///< an open hash table
  std::vector<ContactPoint> points_; ///< one a cell
  std::size_t most_;
};

} // namespace nendo::deform
