#include "deformer/surface_shape.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::deform {

FieldStatus solve_within(const SurfaceField& field, const Points& vectors, double extent,
                         SurfaceField::Coefficients& coefficients) noexcept {
  field.solve(vectors, coefficients);
  // The functions are at most 1, and affine maps of rigid parts reach a few times farther.
  const double most = 1e3 * static_cast<double>(coefficients.all.cols()) *
                      static_cast<double>(coefficients.all.cwiseAbs().maxCoeff());
  if (extent + most <= max_units) return FieldStatus::ok;
  coefficients.all.setZero();
  return FieldStatus::not_finite;
}

void displace(const SurfaceField& field, const SurfaceField::Coefficients& by,
              const BlockShape& from, BoundedShape& to) noexcept {
  field.displace(by, from, to.shape);
  for (std::size_t block = 0; block < to.bounds.size(); ++block) {
    if (!field.reaches(block)) continue;
    to.bounds[block] = bounds_of(to.shape[block]);
    for (const float side : to.bounds[block].sides)
      to.extent = std::max(to.extent, std::abs(static_cast<double>(side)));
  }
}

} // namespace nendo::deform
