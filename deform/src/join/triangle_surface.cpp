#include "join/triangle_surface.hpp"

#include "mesh/used_entries.hpp"

namespace nendo::deform {

void TriangleSurface::copy_points(std::span<const std::uint32_t> which) {
  const auto copy = [&](auto& column) {
    for (std::size_t k = 0; !column.empty() && k < which.size(); ++k)
      column.push_back(column[which[k]]);
  };
  copy(points);
  copy(colours);
  copy(rest);
  copy(detail);
}

void TriangleSurface::renumber_columns(const Renumbering& numbers) {
  keep_values(points, numbers.points, no_index);
  keep_values(colours, numbers.points, no_index);
  keep_values(rest, numbers.points, no_index);
  keep_values(detail, numbers.points, no_index);
  keep_values(looks, numbers.faces, no_index);
  keep_values(face_texture, numbers.faces, no_index);
}

double volume_of(std::span<const SpacePoint> points, std::span<const Corners> faces) {
  if (points.empty()) return 0.0;
  SpacePoint middle{};
  for (const SpacePoint& point : points)
    middle = middle + (1.0 / static_cast<double>(points.size())) * point;
  double six_times = 0.0;
  for (const Corners& corner : faces)
    six_times += dot(points[corner[0]] - middle,
                     cross(points[corner[1]] - middle, points[corner[2]] - middle));
  return six_times / 6.0;
}

/// By way of memory: where numbers become floats and doubles again in one expression, GCC 12 makes
/// vectors of that which leave some as they were.
Eigen::Matrix3Xf round_points(std::span<SpacePoint> points) {
  Eigen::Matrix3Xf rounded(3, static_cast<Eigen::Index>(points.size()));
  Eigen::Index column = 0;
  for (const SpacePoint& point : points)
    rounded.col(column++) = Eigen::Vector3d(point[0], point[1], point[2]).cast<float>();
  column = 0;
  for (SpacePoint& point : points) {
    for (Eigen::Index axis = 0; axis < 3; ++axis)
      point[static_cast<std::size_t>(axis)] = static_cast<double>(rounded(axis, column));
    ++column;
  }
  return rounded;
}

} // namespace nendo::deform
