#include "render/distance_paint.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace nendo::render {

using Eigen::Index;
using Eigen::Vector3f;

namespace {

// Linear. From light to dark, so that it is read without seeing red from green.
const std::array<Vector3f, 5> ramp{
    Vector3f{0.400F, 0.400F, 0.390F}, Vector3f{0.991F, 0.694F, 0.181F},
    Vector3f{0.982F, 0.266F, 0.045F}, Vector3f{0.768F, 0.010F, 0.012F},
    Vector3f{0.216F, 0.000F, 0.019F}};

/// part: 0 to 1.
Vector3f ramp_at(double part) {
  const double place = part * static_cast<double>(ramp.size() - 1);
  const auto before = std::min(static_cast<std::size_t>(place), ramp.size() - 2);
  const auto share = static_cast<float>(place - static_cast<double>(before));
  return (1.0F - share) * ramp[before] + share * ramp[before + 1];
}

double way_of(const deform::Mesh& rest, const deform::Points& shape, Index vertex) {
  const double way = (shape.col(vertex) - rest.vertices.col(vertex)).norm();
  return std::isfinite(way) ? way : 0.0;
}

} // namespace

double farthest_way(const deform::Mesh& rest, const deform::Points& shape) {
  double farthest = 0.0;
  for (Index vertex = 0; vertex < shape.cols(); ++vertex)
    farthest = std::max(farthest, way_of(rest, shape, vertex));
  return farthest;
}

std::shared_ptr<const Paint> paint_by_distance(const deform::Mesh& rest,
                                               const deform::Points& shape, double farthest) {
  deform::Mesh painted = rest; // whose materials decide which triangles are drawn, in what order
  for (deform::Material& material : painted.look.materials) {
    material.colour = Eigen::Vector4f::Ones();
    material.texture = deform::no_index;
  }
  painted.look.texcoord_colours.resize(4, 0);
  painted.look.vertex_colours.setOnes(4, shape.cols());
  for (Index vertex = 0; vertex < shape.cols(); ++vertex)
    painted.look.vertex_colours.col(vertex).head<3>() =
        ramp_at(std::min(1.0, way_of(rest, shape, vertex) / farthest));
  std::vector<std::uint32_t> corners;
  return std::make_shared<const Paint>(painted, corners);
}

} // namespace nendo::render
