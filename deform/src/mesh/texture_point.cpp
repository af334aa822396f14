#include "mesh/texture_point.hpp"

#include <algorithm>

namespace nendo::deform {

TexturePoint texture_point_of(const Mesh& mesh, std::size_t number) noexcept {
  const auto at = static_cast<Eigen::Index>(number);
  TexturePoint point = white_texture_point;
  std::copy_n(mesh.texcoords.col(at).data(), 2, point.begin());
  if (mesh.look.texcoord_colours.cols() > 0)
    std::copy_n(mesh.look.texcoord_colours.col(at).data(), 4, point.begin() + 2);
  return point;
}

void set_texture_points(std::span<const TexturePoint> points, Mesh& mesh) {
  const auto count = static_cast<Eigen::Index>(points.size());
  const bool coloured = std::any_of(points.begin(), points.end(), [](const TexturePoint& point) {
    return std::any_of(point.begin() + 2, point.end(), [](double part) { return part != 1.0; });
  });
  mesh.texcoords.resize(2, count);
  mesh.look.texcoord_colours.resize(4, coloured ? count : 0);
  for (Eigen::Index at = 0; at < count; ++at) {
    const TexturePoint& point = points[static_cast<std::size_t>(at)];
    mesh.texcoords.col(at) << point[0], point[1];
    if (coloured)
      mesh.look.texcoord_colours.col(at) =
          Eigen::Map<const Eigen::Vector4d>(point.data() + 2).cast<float>();
  }
}

} // namespace nendo::deform
