#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include <nendo/puppet/puppet.hpp>

namespace nendo::puppet {

using deform::Points;
using Eigen::Index;
using Eigen::Vector3d;

namespace {

constexpr double tolerance = 1e-4; // of the diagonal, between a vertex and the image of another
constexpr Index max_looked_at = 1000;
constexpr double max_alone = 0.05; // of them

/// Returns which part of the vertices that are looked at has no image in the plane x = at.
double part_alone(const Points& vertices, const std::vector<Index>& by_x, double at) {
  const double near = tolerance * deform::diagonal_of(vertices);
  const Index step = std::max<Index>(1, vertices.cols() / max_looked_at);
  Index looked_at = 0, alone = 0;
  for (Index v = 0; v < vertices.cols(); v += step, ++looked_at) {
    Vector3d image = vertices.col(v);
    image.x() = 2.0 * at - image.x();
    auto other = std::lower_bound(by_x.begin(), by_x.end(), image.x() - near,
                                  [&](Index one, double x) { return vertices(0, one) < x; });
    bool found = false;
    for (; !found && other != by_x.end() && vertices(0, *other) <= image.x() + near; ++other)
      found = (vertices.col(*other) - image).norm() <= near;
    if (!found) ++alone;
  }
  return looked_at == 0 ? 1.0 : static_cast<double>(alone) / static_cast<double>(looked_at);
}

} // namespace

double plane_of_symmetry(const Points& vertices) {
  if (vertices.cols() == 0 || !vertices.allFinite()) return 0.0;
  const double middle = 0.5 * (vertices.row(0).minCoeff() + vertices.row(0).maxCoeff());
  if (std::abs(middle) <= tolerance * deform::diagonal_of(vertices)) return 0.0;
  std::vector<Index> by_x(static_cast<std::size_t>(vertices.cols()));
  for (std::size_t at = 0; at < by_x.size(); ++at)
    by_x[at] = static_cast<Index>(at);
  std::sort(by_x.begin(), by_x.end(),
            [&](Index one, Index other) { return vertices(0, one) < vertices(0, other); });
  return part_alone(vertices, by_x, middle) <= max_alone ? middle : 0.0;
}

} // namespace nendo::puppet
