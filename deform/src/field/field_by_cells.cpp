#include "field/field_by_cells.hpp"

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "field/field_terms.hpp"
#include "geometry/point_grid.hpp"

namespace nendo::deform {

namespace {

/// By cell, and in their own order within one. Points that are not finite are in some cell.
std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted_by_cell(const PointGrid& grid,
                                                                    const Points& points) {
  std::vector<std::pair<std::uint64_t, std::uint32_t>> sorted;
  sorted.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    sorted.emplace_back(grid.cell_of(points.col(i)), static_cast<std::uint32_t>(i));
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

} // namespace

void displace_by_cells(const CsrbfField& field, const Points& points, Points& out) {
  const double reach = field.radii.maxCoeff();
  const PointGrid grid(field.centres, reach);
  const auto sorted = sorted_by_cell(grid, points);
  std::vector<std::uint32_t> functions;
  for (auto begin = sorted.begin(); begin != sorted.end();) {
    Eigen::Vector3d low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    Eigen::Vector3d high = -low;
    auto end = begin;
    for (; end != sorted.end() && end->first == begin->first; ++end) {
      if (!points.col(end->second).allFinite()) continue; // which no function reaches
      low = low.cwiseMin(points.col(end->second));
      high = high.cwiseMax(points.col(end->second));
    }
    functions.clear();
    if (low[0] <= high[0])
      grid.visit_near(low, high, reach, [&](std::uint32_t i) { functions.push_back(i); });
    std::sort(functions.begin(), functions.end());
    for (; begin != end; ++begin) {
      const Eigen::Vector3d x = points.col(begin->second);
      Eigen::Vector3d sum = polynomial_at(field, x);
      for (const std::uint32_t i : functions)
        add_term(field, i, x, sum);
      out.col(begin->second) = x + sum;
    }
  }
}

} // namespace nendo::deform
