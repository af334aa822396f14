#pragma once
// A model seen from the front, as the height of its surface above the plane z = 0.

#include <cstddef>
#include <optional>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::puppet {

/// For each place (x, y), the greatest z of the surface. It does not change.
class FrontMap {
public:
  /// Allocates a cell for each 1/800 of the model's height, or of its width if that is more.
  explicit FrontMap(const deform::Mesh& model);

  double cell() const noexcept { return cell_; } ///< the side of a cell, model units
  /// Returns z there; nothing where there is no surface. All in model units.
  std::optional<double> z(double x, double y) const noexcept;
  /// Returns the place there; where there is no surface, that at z = 0.
  Eigen::Vector3d place(double x, double y) const noexcept { return {x, y, z(x, y).value_or(0.0)}; }
  double lowest_y() const noexcept { return box_.lowest.y(); }
  double highest_y() const noexcept { return box_.highest.y(); }

private:
  void draw(const Eigen::Matrix3d& corners);

  deform::Box box_;
  double cell_ = 1.0;
  std::ptrdiff_t columns_ = 0;
  std::ptrdiff_t rows_ = 0;
  std::vector<double> cells_; ///< row by row from the lowest y
};

} // namespace nendo::puppet
