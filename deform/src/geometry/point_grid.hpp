#pragma once
// Points sorted into cubes, so that those near a place are found without looking at all points.

#include <algorithm>
#include <array>
#include <compare>
#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::deform {

class PointGrid {
public:
  /// Coordinates of points must be finite and at most 1e100. cell_edge must be > 0; it is enlarged
  /// if there would be more than 2^21 cells along an axis. Allocates.
  PointGrid(const Points& points, double cell_edge);

  /// Returns the number of a place's cell: x in the lowest 21 bits, then y, then z. Places outside
  /// the points' box belong to the cells at its border.
  std::uint64_t cell_of(const Eigen::Vector3d& place) const noexcept;

  /// Calls visit(index) for every point within `reach` of the box, and for some others, in no
  /// order.
  template <class Visit>
  void visit_near(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double reach,
                  const Visit& visit) const {
    // The most that rounding may take from a distance.
    const double margin =
        reach * 1e-12 + 1e-15 * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
    const Cell first = cell_at(low.array() - (reach + margin));
    Cell last = cell_at(high.array() + (reach + margin));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      last[axis] = std::min(last[axis], highest_[axis]);
      if (first[axis] > last[axis]) return;
    }
    const std::uint64_t rows = (last[1] - first[1] + 1) * (last[2] - first[2] + 1);
    if (rows >= sorted_.size()) {
      for (const Entry& entry : sorted_)
        visit(entry.point);
      return;
    }
    for (std::uint64_t z = first[2]; z <= last[2]; ++z)
      for (std::uint64_t y = first[1]; y <= last[1]; ++y) {
        const std::uint64_t end = key_of({last[0], y, z});
        for (auto at = first_from({first[0], y, z}); at != sorted_.end() && at->key <= end; ++at)
          visit(at->point);
      }
  }

private:
  static constexpr int bits = 21;
  using Cell = std::array<std::uint64_t, 3>;
  struct Entry {
    std::uint64_t key;
    std::uint32_t point;
    auto operator<=>(const Entry&) const = default;
  };

  static std::uint64_t key_of(const Cell& cell) noexcept {
    return cell[2] << (2 * bits) | cell[1] << bits | cell[0];
  }
  Cell cell_at(const Eigen::Vector3d& place) const noexcept;
  void index_cells();
  std::size_t number_of(const Cell& cell) const noexcept {
    return (cell[2] * (highest_[1] + 1) + cell[1]) * (highest_[0] + 1) + cell[0];
  }
  /// Returns the first entry of that cell or of the cells after it.
  std::vector<Entry>::const_iterator first_from(const Cell& cell) const noexcept {
    if (!begins_.empty()) return sorted_.begin() + begins_[number_of(cell)];
    return std::lower_bound(sorted_.begin(), sorted_.end(), key_of(cell),
                            [](const Entry& entry, std::uint64_t key) { return entry.key < key; });
  }

  Eigen::Vector3d lowest_ = Eigen::Vector3d::Zero();
  Cell highest_{}; ///< the highest cell of a point
  double cells_per_unit_ = 1.0;
  std::vector<Entry> sorted_;
  std::vector<std::uint32_t>
      begins_; ///< each cell's first entry in sorted_, if there are not many more cells
};

} // namespace nendo::deform
