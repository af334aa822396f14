#include "front_map.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include <Eigen/Geometry>

#include <nendo/deform/triangles.hpp>

namespace nendo::puppet {

namespace {

constexpr double nothing = -std::numeric_limits<double>::infinity();
constexpr double cells_a_side = 800.0;

} // namespace

FrontMap::FrontMap(const deform::Mesh& model) : box_(deform::finite_box_of(model.vertices)) {
  const Eigen::Vector3d size = box_.highest - box_.lowest;
  const double longest = std::max(size.x(), size.y());
  cell_ = longest > 0.0 ? longest / cells_a_side : 1.0;
  columns_ = static_cast<std::ptrdiff_t>(size.x() / cell_) + 2;
  rows_ = static_cast<std::ptrdiff_t>(size.y() / cell_) + 2;
  cells_.assign(static_cast<std::size_t>(columns_ * rows_), nothing);
  deform::for_each_triangle(model, [&](const std::array<std::uint32_t, 3>& triangle) {
    Eigen::Matrix3d corners;
    for (std::size_t k = 0; k < 3; ++k)
      corners.col(static_cast<Eigen::Index>(k)) = model.vertices.col(triangle[k]);
    if (corners.allFinite()) draw(corners);
  });
}

void FrontMap::draw(const Eigen::Matrix3d& corners) {
  const Eigen::Matrix2d sides =
      (Eigen::Matrix2d() << corners.col(1).head<2>() - corners.col(0).head<2>(),
       corners.col(2).head<2>() - corners.col(0).head<2>())
          .finished();
  const double area = sides.determinant();
  if (std::abs(area) < 1e-12 * cell_ * cell_) return; // seen from its edge
  const Eigen::Matrix2d inverse = sides.inverse();
  const Eigen::Vector3d low = (corners.rowwise().minCoeff() - box_.lowest) / cell_;
  const Eigen::Vector3d high = (corners.rowwise().maxCoeff() - box_.lowest) / cell_;
  const auto last_column = std::min(columns_ - 1, static_cast<std::ptrdiff_t>(high.x()) + 1);
  const auto last_row = std::min(rows_ - 1, static_cast<std::ptrdiff_t>(high.y()) + 1);
  for (auto row = static_cast<std::ptrdiff_t>(low.y()); row <= last_row; ++row)
    for (auto column = static_cast<std::ptrdiff_t>(low.x()); column <= last_column; ++column) {
      const Eigen::Vector2d at =
          box_.lowest.head<2>() + cell_ * Eigen::Vector2d(static_cast<double>(column) + 0.5,
                                                          static_cast<double>(row) + 0.5);
      const Eigen::Vector2d part = inverse * (at - corners.col(0).head<2>());
      if (part.minCoeff() < -1e-9 || part.sum() > 1.0 + 1e-9) continue;
      const double z = corners(2, 0) + part.x() * (corners(2, 1) - corners(2, 0)) +
                       part.y() * (corners(2, 2) - corners(2, 0));
      double& cell = cells_[static_cast<std::size_t>(row * columns_ + column)];
      cell = std::max(cell, z);
    }
}

std::optional<double> FrontMap::z(double x, double y) const noexcept {
  const double column = std::floor((x - box_.lowest.x()) / cell_);
  const double row = std::floor((y - box_.lowest.y()) / cell_);
  if (!(column >= 0.0 && row >= 0.0 && column < static_cast<double>(columns_) &&
        row < static_cast<double>(rows_)))
    return std::nullopt;
  const double z = cells_[static_cast<std::size_t>(row) * static_cast<std::size_t>(columns_) +
                          static_cast<std::size_t>(column)];
  if (z == nothing) return std::nullopt;
  return z;
}

} // namespace nendo::puppet
