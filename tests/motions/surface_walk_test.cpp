#include "motions/surface_walk.hpp"

#include <algorithm>
#include <random>

#include <doctest/doctest.h>

#include "support/surface_distance.hpp"
#include "support/test_meshes.hpp"

namespace surface_walk_test {

using namespace nendo;
using namespace nendo::motions;
using Eigen::Vector3d;

namespace {

/// Triangles anywhere, slivers and points among them; nothing that one would call a surface.
deform::Mesh rubble(std::mt19937& random) {
  deform::Mesh mesh;
  mesh.vertices = test::random_points(random, 60, 1.0);
  mesh.vertices.col(1) = mesh.vertices.col(0);
  mesh.vertices.col(2) = mesh.vertices.col(0);                                // a point
  mesh.vertices.col(5) = 0.5 * (mesh.vertices.col(3) + mesh.vertices.col(4)); // a line
  for (std::uint32_t at = 0; at + 2 < 60; at += 3)
    test::add_face(mesh, {at, at + 1, at + 2});
  return mesh;
}

SurfacePatch whole(const deform::Mesh& mesh) {
  return SurfacePatch(mesh, deform::vertex_normals(mesh), 1.0, Vector3d::Zero(), 100.0);
}

} // namespace

TEST_SUITE("surface_walk") {
  TEST_CASE("the nearest point is as near as the nearest of all triangles, and on one of them") {
    std::mt19937 random(7);
    for (int round = 0; round < 20; ++round) {
      const deform::Mesh mesh = round == 0 ? test::sphere(6, 9, 1.0) : rubble(random);
      const SurfacePatch patch = whole(mesh);
      const deform::Points places = test::random_points(random, 40, 2.0);
      for (Eigen::Index k = 0; k < places.cols(); ++k) {
        const auto nearest = patch.nearest(places.col(k));
        REQUIRE(nearest);
        const double off = (nearest->position_m - places.col(k)).norm();
        CHECK(off == doctest::Approx(test::nearest_triangle(mesh, places.col(k)).distance));
        CHECK(test::nearest_triangle(mesh, nearest->position_m).distance < 1e-9);
      }
    }
  }

  TEST_CASE("a part of the surface has all that is near its centre") {
    std::mt19937 random(8);
    deform::Mesh mesh = test::sphere(40, 60, 1.0);
    mesh.vertices *= 100.0; // centimetres
    const deform::Points normals = deform::vertex_normals(mesh);
    for (int round = 0; round < 50; ++round) {
      const Vector3d centre = 1.3 * Vector3d::Random().normalized();
      const SurfacePatch patch(mesh, normals, 100.0, centre, 0.1);
      const auto nearest = patch.nearest(centre);
      REQUIRE(nearest);
      CHECK(100.0 * (nearest->position_m - centre).norm() ==
            doctest::Approx(test::nearest_triangle(mesh, 100.0 * centre).distance));
      CHECK(nearest->normal.dot(centre.normalized()) > 0.99);
    }
  }

  TEST_CASE("a walk stays on the surface and never jumps, even on rubble") {
    std::mt19937 random(9);
    for (int round = 0; round < 20; ++round) {
      const deform::Mesh mesh = round == 0 ? test::sphere(6, 9, 1.0) : rubble(random);
      const Vector3d start = test::random_points(random, 1, 1.0).col(0);
      const auto way = walk(whole(mesh), start, Vector3d(1.0, 0.4, -0.2), 0.5, 0.01);
      REQUIRE(!way.empty());
      CHECK(way.size() <= 51);
      for (std::size_t k = 0; k < way.size(); ++k) {
        CHECK(test::nearest_triangle(mesh, way[k].position_m).distance < 1e-9);
        if (k > 0) CHECK((way[k].position_m - way[k - 1].position_m).norm() < 0.0201);
      }
    }
  }

  TEST_CASE("on a ball a walk is a great circle's arc of its length") {
    const auto way = walk(whole(test::sphere(90, 120, 1.0)), Vector3d(1.0, 0.0, 0.0),
                          Vector3d(0.0, 1.0, 0.0), 0.5, 0.002);
    const Vector3d end = way.back().position_m;
    CHECK(std::atan2(end.y(), end.x()) == doctest::Approx(0.5).epsilon(0.01));
    CHECK(std::abs(end.z()) < 0.01);
  }

  TEST_CASE("a model without faces has no nearest point, and no way") {
    deform::Mesh mesh;
    mesh.vertices = deform::Points::Zero(3, 4);
    CHECK(!whole(mesh).nearest(Vector3d::Zero()));
    CHECK(walk(whole(mesh), Vector3d::Zero(), Vector3d::UnitX(), 1.0, 0.1).empty());
  }
}

} // namespace surface_walk_test
