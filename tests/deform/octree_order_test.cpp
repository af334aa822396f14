#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include "geometry/octree_order.hpp"

namespace octree_order_test {

namespace {

using nendo::deform::octree_order;
using nendo::deform::Points;

Points points_in_cube(Eigen::Index count, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(-3.0, 5.0);
  Points points(3, count);
  for (double& coordinate : points.reshaped())
    coordinate = place(random);
  return points;
}

/// Whether every cell of the octree down to `levels` holds one run of the list: the law of a
/// depth-first visit, checked from the cells and not from the codes.
bool cells_are_runs(const Points& points, const std::vector<std::uint32_t>& order, int levels) {
  const Eigen::Vector3d lowest = points.rowwise().minCoeff();
  const double edge = (points.rowwise().maxCoeff() - lowest).maxCoeff();
  for (int level = 1; level <= levels; ++level) {
    const double cells = std::pow(2.0, level);
    std::vector<Eigen::Vector3d> seen;
    Eigen::Vector3d last = Eigen::Vector3d::Constant(-1.0);
    for (const auto index : order) {
      const Eigen::Vector3d cell =
          ((points.col(index) - lowest) / edge * cells).array().floor().min(cells - 1.0);
      if (cell == last) continue;
      if (std::find(seen.begin(), seen.end(), cell) != seen.end()) return false;
      seen.push_back(cell);
      last = cell;
    }
  }
  return true;
}

} // namespace

TEST_SUITE("octree_order") {
  TEST_CASE("the order is a permutation, and every cell of the octree is one run of it") {
    const Points points = points_in_cube(400, 1);
    const auto order = octree_order(points);
    std::vector<std::uint32_t> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    std::vector<std::uint32_t> all(400);
    std::iota(all.begin(), all.end(), 0u);
    CHECK(sorted == all);
    CHECK(cells_are_runs(points, order, 3));
    CHECK_FALSE(cells_are_runs(points, all, 3)); // as they came, they are not
  }

  TEST_CASE("moving or scaling all points by a power of two changes nothing") {
    const Points points = points_in_cube(100, 2);
    CHECK(octree_order(4.0 * points) == octree_order(points));
  }

  TEST_CASE("equal points keep their order, and points that are not finite come last") {
    Points points = Points::Zero(3, 4);
    CHECK(octree_order(points) == std::vector<std::uint32_t>{0, 1, 2, 3});
    points(1, 0) = std::numeric_limits<double>::quiet_NaN();
    points(0, 2) = 1.0;
    points(2, 3) = -std::numeric_limits<double>::infinity();
    CHECK(octree_order(points) == std::vector<std::uint32_t>{1, 2, 0, 3});
    CHECK(octree_order(Points(3, 0)).empty());
    points.setConstant(std::numeric_limits<double>::max());
    points.rightCols<3>() *= -1.0;
    CHECK(octree_order(points) == std::vector<std::uint32_t>{1, 2, 3, 0});
  }
}

} // namespace octree_order_test
