#include "clay/volume_keeper.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/triangles.hpp>

#include "reference/icosphere.hpp"
#include "support/contact_parts.hpp"
#include "support/self_intersections.hpp"
#include "support/test_meshes.hpp"

namespace volume_keeper_test {

using namespace nendo::deform;
using Eigen::Vector3d;

namespace {

double signed_volume(const Mesh& mesh, const Points& vertices) {
  double sum = 0.0;
  for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& corners) {
    sum += vertices.col(corners[0]).dot(vertices.col(corners[1]).cross(vertices.col(corners[2])));
  });
  return sum / 6.0;
}

} // namespace

TEST_SUITE("volume_keeper") {
  TEST_CASE("only closed, oriented surfaces have a volume") {
    Mesh ball = nendo::reference::icosphere(2, 1.0);
    const BlockLayout layout(ball.vertices);
    std::vector<std::uint32_t> corners = corners_of_triangles(ball);
    CHECK(VolumeKeeper(layout, corners).is_closed());
    CHECK_FALSE(VolumeKeeper(layout, {}).is_closed());
    std::vector<std::uint32_t> turned = corners;
    std::swap(turned[0], turned[1]);
    CHECK_FALSE(VolumeKeeper(layout, turned).is_closed());
    corners.resize(corners.size() - 3);
    CHECK_FALSE(VolumeKeeper(layout, corners).is_closed());
  }

  TEST_CASE("the volume is the divergence theorem's, also after some blocks have moved") {
    const Mesh ball = nendo::reference::icosphere(4, 5.0);
    const BlockLayout layout(ball.vertices);
    BoundedShape shape(layout.pack());
    VolumeKeeper keeper(layout, corners_of_triangles(ball));
    const double cube = std::pow(layout.unit(), 3.0);
    CHECK(keeper.volume(shape) * cube ==
          doctest::Approx(signed_volume(ball, ball.vertices)).epsilon(1e-6));
    std::mt19937 random(51);
    for (int round = 0; round < 10; ++round) {
      const std::size_t block = random() % shape.shape.block_count();
      for (float& x : shape.shape.data()[block].x)
        x *= 1.1F;
      if (block + 1 == shape.shape.block_count()) continue; // its padding repeats a vertex
      shape.shape.set_stamp(block, BlockShape::new_stamp());
      Points now;
      layout.unpack(shape.shape, now);
      CHECK(keeper.volume(shape) * cube == doctest::Approx(signed_volume(ball, now)).epsilon(1e-6));
    }
  }

  TEST_CASE("a vertex may have more neighbours than a byte counts") {
    for (const std::uint32_t around : {100U, 300U, 1000U}) {
      CAPTURE(around);
      const Mesh cones = nendo::test::sphere(1, around, 1.0);
      const BlockLayout layout(cones.vertices);
      const BoundedShape shape(layout.pack());
      VolumeKeeper keeper(layout, corners_of_triangles(cones));
      REQUIRE(keeper.is_closed());
      CHECK(keeper.volume(shape) * std::pow(layout.unit(), 3.0) ==
            doctest::Approx(signed_volume(cones, cones.vertices)).epsilon(1e-5));
    }
  }

  TEST_CASE("what is missing comes back, but not at a body nor far from the contacts") {
    const Mesh ball = nendo::reference::icosphere(4, 30.0);
    const BlockLayout layout(ball.vertices);
    BoundedShape shape(layout.pack());
    VolumeKeeper keeper(layout, corners_of_triangles(ball));
    const double mm = 1.0 / layout.unit();
    ContactSearch search(1, 1);
    const std::vector<ContactPart> body{
        nendo::test::cone(Vector3d(0, 0, 38) * mm, Vector3d(0, 0, 60) * mm, 8 * mm, 8 * mm)};
    search.set_parts(body);
    const double whole = keeper.volume(shape);
    const BoxGate around =
        BoxGate::of(nendo::test::cone(Vector3d(0, 0, 30) * mm, Vector3d(0, 0, 30) * mm, mm, mm));
    const double given =
        keeper.give_back(shape, search, 0.01 * whole, {10 * mm, 5 * mm, &around, 25 * mm});
    CHECK(given == doctest::Approx(0.01 * whole));
    CHECK(keeper.volume(shape) / whole == doctest::Approx(1.01).epsilon(1e-3));
    Points now;
    layout.unpack(shape.shape, now);
    int free = 0;
    for (Eigen::Index at = 0; at < now.cols(); ++at) {
      const Vector3d before = ball.vertices.col(at);
      const double moved = (now.col(at) - before).norm();
      if (before.z() < 3.9) CHECK(moved == 0.0);
      if ((before - Vector3d(0, 0, 30)).norm() < 1.0) CHECK(moved < 0.1);
      free += moved > 0.2 ? 1 : 0;
    }
    CHECK(free > 100);
    // No vertex goes farther than it may.
    const double little = keeper.give_back(shape, search, whole, {10 * mm, mm, nullptr, 25 * mm});
    CHECK(little > 0.0);
    CHECK(little < 0.2 * whole);
    Points after;
    layout.unpack(shape.shape, after);
    CHECK((after - now).colwise().norm().maxCoeff() < 1.0 + 0.3 * 2.0);
    CHECK((after.row(2).minCoeff()) == doctest::Approx(now.row(2).minCoeff() - 1.0).epsilon(0.02));
  }

  TEST_CASE("walls of a crease do not cross while the ball swells by half an edge and more") {
    Mesh ball = nendo::reference::icosphere(5, 30.0);
    for (Eigen::Index at = 0; at < ball.vertices.cols(); ++at)
      if (auto place = ball.vertices.col(at); place.z() > 0.0)
        place *= 1.0 - place.z() / 100.0 * std::max(0.0, 1.0 - std::abs(place.x()) / 9.0);
    REQUIRE(nendo::test::count_self_intersections(ball) == 0);
    const BlockLayout layout(ball.vertices);
    BoundedShape shape(layout.pack());
    VolumeKeeper keeper(layout, corners_of_triangles(ball));
    const double mm = 1.0 / layout.unit();
    ContactSearch search(1, 1);
    search.set_parts(std::vector<ContactPart>{
        nendo::test::cone(Vector3d(0, 0, 380) * mm, Vector3d(0, 0, 400) * mm, mm, mm)});
    const double whole = keeper.volume(shape);
    Mesh now = ball;
    for (int call = 1; call <= 5; ++call) { // 0.3 mm each
      const double missing = (1.0 + 0.03 * call) * whole - keeper.volume(shape);
      keeper.give_back(shape, search, missing, {10 * mm, 5 * mm, nullptr, 25 * mm});
      layout.unpack(shape.shape, now.vertices);
      CHECK(nendo::test::count_self_intersections(now) == 0);
    }
    CHECK(keeper.volume(shape) / whole == doctest::Approx(1.15).epsilon(1e-3));
  }
}

} // namespace volume_keeper_test
