#pragma once
// Chooses the places at which a body pushes: the deepest vertex of each cell of space, one a part,
// and of those only such as do not crowd.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Core>

#include "simd/contact_kernels.hpp"

namespace nendo::deform {

/// Places of which none is to crowd another.
class CrowdedPlaces {
public:
  /// Allocates for so many places; nothing else does.
  explicit CrowdedPlaces(std::size_t most);

  void clear() noexcept;
  /// Adds a place, unless one is nearer than the root of `squared` whose normal is within 60
  /// degrees of its normal. Returns whether it did. There must be room.
  bool add(const Eigen::Vector3f& at, const Eigen::Vector3f& normal, float squared) noexcept;

private:
  std::size_t count_ = 0;
  std::array<std::vector<float>, 6> rows_; ///< places and normals; beyond the last, far away
};

struct ContactPoint {
  std::uint32_t place = 0; ///< of the vertex, in block order
  std::uint32_t body = 0;
  std::uint32_t part = 0;
  double depth = 0.0; ///< negative outside
  Eigen::Vector3d at = Eigen::Vector3d::Zero();
  Eigen::Vector3d normal = Eigen::Vector3d::Zero(); ///< out of the body
};

/// A vertex near a body, as a search has found it. It takes little room, because many are kept.
struct NearVertex {
  std::uint32_t place = 0;
  std::uint32_t body = 0;
  std::uint32_t part = 0;
  float depth = 0.0F; ///< negative outside
  Eigen::Vector3f at = Eigen::Vector3f::Zero();
  Eigen::Vector3f centre = Eigen::Vector3f::Zero(); ///< of the part's ball that is the nearest
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
  /// Keeps the vertex if it is the deepest yet of its cell and part. The first of those that are
  /// equally deep stays. When the table is full, vertices of new cells are left out; the next pass
  /// meets them. Not after choose().
  void offer(const NearVertex& vertex) noexcept;
  /// Returns the deepest, none nearer than `apart` to a deeper one that pushes into nearly the same
  /// direction; at most as many as there is room for. Until the next clear() they stay the same.
  std::span<const ContactPoint> choose(double apart) noexcept;

private:
  struct Slot {
    std::uint64_t key = 0;
    std::uint32_t round = 0; ///< of the choice to which it belongs
    std::uint32_t vertex = 0;
  };

  SpaceCells cells_{};
  std::uint32_t round_ = 0;
  std::vector<Slot> slots_;          ///< an open hash table
  std::vector<NearVertex> vertices_; ///< one a cell
  CrowdedPlaces places_;             ///< of those chosen
  std::vector<ContactPoint> chosen_;
  bool is_chosen_ = false; ///< since clear()
};

} // namespace nendo::deform
