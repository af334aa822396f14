#include "geometry/box_tree.hpp"
#include "geometry/triangle_meeting.hpp"

#include <array>
#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace triangle_meeting_test {

using namespace nendo::deform;

TEST_SUITE("triangle meeting") {
  bool meet(const std::vector<SpacePoint>& points, const Corners& one, const Corners& other) {
    const bool found = triangles_meet(points, one, other);
    // Neither the order of the two nor that of their corners matters.
    CHECK(triangles_meet(points, other, one) == found);
    CHECK(triangles_meet(points, {one[2], one[1], one[0]}, {other[1], other[2], other[0]}) ==
          found);
    return found;
  }

  TEST_CASE("triangles of two planes") {
    const std::vector<SpacePoint> points{{0, 0, 0},  {4, 0, 0}, {0, 4, 0}, // 0 1 2: on the ground
                                         {1, 1, -1}, {1, 1, 1}, {3, 3, 1},  {1, 1, 0},  // 3 4 5 6
                                         {1, 1, 5},  {2, 1, 5}, {9, 9, -1}, {2, 2, 0}}; // 7 8 9 10
    CHECK(meet(points, {0, 1, 2}, {3, 4, 5}));  // an edge pierces
    CHECK(meet(points, {0, 1, 2}, {6, 4, 5}));  // a corner touches the inside
    CHECK(meet(points, {0, 1, 2}, {10, 4, 5})); // a corner touches an edge
    CHECK(!meet(points, {0, 1, 2}, {7, 8, 4})); // above
    CHECK(!meet(points, {0, 1, 2}, {9, 5, 4})); // it goes through the plane, beside
    CHECK(!meet(points, {0, 1, 2}, {0, 4, 7})); // a shared corner alone
    CHECK(meet(points, {0, 1, 2}, {0, 3, 5}));  // a shared corner, and more
    CHECK(!meet(points, {0, 1, 2}, {0, 1, 7})); // a shared edge alone
    CHECK(meet(points, {0, 1, 2}, {0, 1, 2}));  // the same
  }

  TEST_CASE("triangles of one plane") {
    const std::vector<SpacePoint> points{{0, 0, 3},  {4, 0, 3}, {0, 4, 3},   {1, 1, 3},
                                         {2, 1, 3},  {1, 2, 3}, {-1, -1, 3}, {8, 0, 3},
                                         {0, -4, 3}, {4, 4, 3}, {8, 4, 3}};
    CHECK(meet(points, {0, 1, 2}, {3, 4, 5}));  // within
    CHECK(meet(points, {0, 1, 2}, {6, 4, 5}));  // overlapping
    CHECK(!meet(points, {0, 1, 2}, {0, 1, 8})); // a shared edge, on both sides
    CHECK(meet(points, {0, 1, 2}, {0, 1, 3}));  // a shared edge, on one side
    CHECK(!meet(points, {0, 1, 2}, {1, 7, 9})); // a shared corner alone
    CHECK(meet(points, {0, 1, 2}, {1, 3, 4}));  // a shared corner, within
    CHECK(meet(points, {0, 1, 2}, {0, 7, 8}));  // along a shared line
    CHECK(!meet(points, {0, 1, 2}, {7, 10, 9}));
  }

  TEST_CASE("the last bit parts two triangles") {
    std::vector<SpacePoint> points{{0, 0, 0},     {1, 0, 0},     {0, 1, 0},
                                   {0.3, 0.3, 0}, {0.3, 0.3, 1}, {0.4, 0.3, 1}};
    CHECK(meet(points, {0, 1, 2}, {3, 4, 5}));
    points[3][2] = 1e-300;
    CHECK(!meet(points, {0, 1, 2}, {3, 4, 5}));
  }

  TEST_CASE("the tree finds every pair that meets") {
    std::mt19937 random(2);
    std::uniform_int_distribution<int> coordinate(0, 12);
    std::vector<SpacePoint> points;
    std::vector<Corners> triangles;
    for (std::uint32_t k = 0; k < 200; ++k) {
      for (int corner = 0; corner < 3; ++corner) {
        const double x = coordinate(random), y = coordinate(random), z = coordinate(random);
        points.push_back({x, y, z / 4.0});
      }
      triangles.push_back({3 * k, 3 * k + 1, 3 * k + 2});
    }
    const BoxTree tree(points, triangles);
    std::size_t pairs = 0, found = 0;
    for (std::uint32_t a = 0; a < triangles.size(); ++a) {
      for (std::uint32_t b = 0; b < triangles.size(); ++b)
        pairs += a != b && triangles_meet(points, triangles[a], triangles[b]) ? 1U : 0U;
      const SpaceBox box = box_around(points, triangles[a]);
      tree.visit([&](const SpaceBox& other) { return nendo::deform::meet(box, other); },
                 [&](std::uint32_t b) {
                   found += a != b && triangles_meet(points, triangles[a], triangles[b]) ? 1U : 0U;
                 });
    }
    CHECK(pairs > 500);
    CHECK(found == pairs);
  }
}

} // namespace triangle_meeting_test
