#include "geometry/point_grid.hpp"

#include <cmath>

namespace nendo::deform {

PointGrid::PointGrid(const Points& points, double cell_edge) {
  if (points.cols() == 0) return;
  lowest_ = points.rowwise().minCoeff();
  const Eigen::Vector3d highest = points.rowwise().maxCoeff();
  const double extent = (highest - lowest_).maxCoeff();
  const double edge = std::max({cell_edge, std::ldexp(extent, -bits), 1e-200});
  cells_per_unit_ = 1.0 / edge;
  highest_ = cell_at(highest);
  sorted_.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    sorted_.push_back({cell_of(points.col(i)), static_cast<std::uint32_t>(i)});
  std::sort(sorted_.begin(), sorted_.end());
  index_cells();
}

/// Where a cell begins is then read instead of searched, if cells are about as many as points.
void PointGrid::index_cells() {
  const std::uint64_t most = 4 * sorted_.size();
  std::uint64_t cells = 1;
  for (const std::uint64_t highest : highest_) {
    cells *= highest + 1; // of 22 bits each
    if (cells > most) return;
  }
  begins_.reserve(cells);
  std::size_t at = 0;
  Cell cell{};
  for (cell[2] = 0; cell[2] <= highest_[2]; ++cell[2])
    for (cell[1] = 0; cell[1] <= highest_[1]; ++cell[1])
      for (cell[0] = 0; cell[0] <= highest_[0]; ++cell[0]) {
        while (at < sorted_.size() && sorted_[at].key < key_of(cell))
          ++at;
        begins_.push_back(static_cast<std::uint32_t>(at)); // as number_of() counts them
      }
}

PointGrid::Cell PointGrid::cell_at(const Eigen::Vector3d& place) const noexcept {
  constexpr double last = (1 << bits) - 1;
  Cell cell;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<Eigen::Index>(axis);
    const double offset = (place[at] - lowest_[at]) * cells_per_unit_;
    cell[axis] = offset > 0.0 ? static_cast<std::uint64_t>(std::min(offset, last)) : 0; // NaN: 0
  }
  return cell;
}

std::uint64_t PointGrid::cell_of(const Eigen::Vector3d& place) const noexcept {
  return key_of(cell_at(place));
}

} // namespace nendo::deform
