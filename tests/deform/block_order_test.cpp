// Which vertices share a block, as BlockLayout shows it.

#include <algorithm>
#include <cstdint>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/vertex_blocks.hpp>

#include "geometry/octree_order.hpp"
#include "support/test_meshes.hpp"

namespace block_order_test {

using namespace nendo::deform;

namespace {

/// Pairs of a block and a ball around a vertex (every seventh) that meets the block's bounds.
std::size_t meetings(const Points& points, const std::vector<std::uint32_t>& order, double radius) {
  std::size_t count = 0;
  for (std::size_t begin = 0; begin < order.size(); begin += block_size) {
    Eigen::Vector3d low = points.col(order[begin]);
    Eigen::Vector3d high = low;
    for (std::size_t at = begin; at < std::min(begin + block_size, order.size()); ++at) {
      low = low.cwiseMin(points.col(order[at]));
      high = high.cwiseMax(points.col(order[at]));
    }
    for (Eigen::Index i = 0; i < points.cols(); i += 7) {
      const Eigen::Vector3d centre = points.col(i);
      const Eigen::Vector3d nearest = centre.cwiseMax(low).cwiseMin(high);
      if ((nearest - centre).norm() <= radius) ++count;
    }
  }
  return count;
}

} // namespace

TEST_SUITE("block_order") {
  TEST_CASE("a sheet of 32 by 32 falls into squares of 8 by 8, in whichever order it came") {
    const Points sheet = nendo::test::grid(31, 1.0).vertices;
    std::vector<std::uint32_t> came(1024);
    std::iota(came.begin(), came.end(), 0U);
    for (int round = 0; round < 3; ++round) {
      Points points(3, 1024);
      for (std::size_t at = 0; at < came.size(); ++at)
        points.col(static_cast<Eigen::Index>(at)) = sheet.col(came[at]);
      const BlockLayout layout(points);
      const BlockShape shape = layout.pack();
      for (std::size_t block = 0; block < layout.block_count(); ++block) {
        const auto sides = bounds_of(shape[block]).sides;
        const float longest = -std::min({sides[0] + sides[4], sides[1] + sides[5]});
        CHECK(layout.unit() * static_cast<double>(longest) == doctest::Approx(7.0 / 31.0));
      }
      std::shuffle(came.begin(), came.end(), std::mt19937(static_cast<unsigned>(round)));
    }
  }

  TEST_CASE("supports meet fewer blocks than in the order of an octree") {
    for (const auto& mesh : {nendo::test::grid(70, 1.0), nendo::test::sphere(60, 90, 0.5)}) {
      const BlockLayout layout(mesh.vertices);
      for (const double radius : {0.05, 0.2}) {
        const std::size_t octree = meetings(mesh.vertices, octree_order(mesh.vertices), radius);
        CHECK(20 * meetings(mesh.vertices, layout.order(), radius) < 19 * octree);
      }
    }
  }

  TEST_CASE("a permutation, in a block by index, and what is not finite comes last") {
    for (const Eigen::Index count : {1, 63, 64, 65, 1000, 2047, 2048, 2049, 40'000}) {
      std::mt19937 random(7);
      Points points = nendo::test::random_points(random, count, 1.0);
      points(1, 0) = std::numeric_limits<double>::quiet_NaN();
      points(2, count / 2) = std::numeric_limits<double>::infinity();
      const BlockLayout layout(points);
      const auto& order = layout.order();
      auto sorted = order;
      std::sort(sorted.begin(), sorted.end());
      std::vector<std::uint32_t> all(static_cast<std::size_t>(count));
      std::iota(all.begin(), all.end(), 0U);
      CHECK(sorted == all);
      CHECK(order.back() == count / 2);
      if (count > 1) CHECK(order[order.size() - 2] == 0);
      const std::size_t finite = order.size() < 2 ? 0 : order.size() - 2;
      for (std::size_t at = 1; at < finite; ++at)
        if (at % block_size != 0) CHECK(order[at - 1] < order[at]);
    }
  }

  TEST_CASE(
      "points in one place, on a line, or at the ends of double keep the order they came in") {
    Points points = Points::Zero(3, 500);
    std::vector<std::uint32_t> all(500);
    std::iota(all.begin(), all.end(), 0U);
    CHECK(BlockLayout(points).order() == all);
    for (const double step : {1e-300, 1.0, 3e305}) {
      for (Eigen::Index i = 0; i < 500; ++i)
        points(2, i) = step * static_cast<double>(i);
      CHECK(BlockLayout(points).order() == all);
    }
    CHECK(BlockLayout(Points(3, 0)).order().empty());
  }
}

} // namespace block_order_test
