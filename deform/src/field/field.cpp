// Fields of Wendland's functions, evaluated in double, and the names of the functions.

#include <nendo/base/text.hpp>
#include <nendo/deform/field.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include <nendo/deform/volume_kernel.hpp>

#include "geometry/point_grid.hpp"

namespace nendo::deform {

namespace {

constexpr std::array<std::string_view, 4> wendland_names{"wendland-c0", "wendland-c2",
                                                         "wendland-c4", "wendland-c6"};

/// From here on, sorting costs less than asking every function about every point.
constexpr Eigen::Index min_by_cells = 256;

bool is_zero(const CsrbfField& field) {
  return field.coefficients.isZero(0.0) && field.polynomial.isZero(0.0);
}

Eigen::Vector3d polynomial_at(const CsrbfField& field, const Eigen::Vector3d& x) noexcept {
  return field.polynomial.col(0) + field.polynomial.rightCols<3>() * x;
}

/// Adds the field's i-th function at x to `sum`.
void add_term(const CsrbfField& field, Eigen::Index i, const Eigen::Vector3d& x,
              Eigen::Vector3d& sum) noexcept {
  const double radius = field.radii[i];
  const double squared = (x - field.centres.col(i)).squaredNorm();
  if (!(squared < radius * radius)) return;
  const double t = std::sqrt(squared) / radius;
  if (field.keep_volume <= 0.0) {
    sum += wendland(field.kernel, t) * field.coefficients.col(i);
    return;
  }
  const Eigen::Vector3d u = (x - field.centres.col(i)) / radius;
  const VolumeKernel kernel = volume_kernel(field.kernel, field.keep_volume, t);
  sum += kernel.identity * field.coefficients.col(i) +
         kernel.offset * u.dot(field.coefficients.col(i)) * u;
}

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

/// Computes what displace() does, bit for bit: a point's terms are added in the same order, without
/// those that are out of reach. It takes time only for the functions in reach. `out` must have as
/// many columns as `points`, and may be `points` itself.
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

} // namespace

std::string_view name_of(Wendland kernel) noexcept {
  return wendland_names[static_cast<std::size_t>(kernel)];
}

std::optional<Wendland> wendland_named(std::string_view name) noexcept {
  return enumerator_named<Wendland>(wendland_names, name);
}

Eigen::Vector3d CsrbfField::displacement_at(const Eigen::Vector3d& x) const noexcept {
  Eigen::Vector3d sum = polynomial_at(*this, x);
  for (Eigen::Index i = 0; i < centres.cols(); ++i)
    add_term(*this, i, x, sum);
  return sum;
}

void displace(const CsrbfField& field, const Points& points, Points& out) {
  if (out.cols() != points.cols()) out.resize(3, points.cols());
  if (is_zero(field)) {
    out = points; // adding +0 would turn a coordinate of -0 into +0
    return;
  }
  if (field.centres.cols() >= min_by_cells && points.cols() > 1) {
    displace_by_cells(field, points, out);
    return;
  }
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d x = points.col(i);
    out.col(i) = x + field.displacement_at(x);
  }
}

void displace(std::span<const CsrbfField> fields, const Points& points, Points& out) {
  out = points;
  Points places; // where the next field is evaluated, if not where the points are
  Points moved;
  for (const CsrbfField& field : fields) {
    if (field.is_halfway) {
      displace(field, out, places);
    } else if (places.size() == 0) {
      displace(field, out, out);
    } else {
      displace(field, places, moved);
      out += moved - places;
      places.resize(3, 0);
    }
  }
}

} // namespace nendo::deform
