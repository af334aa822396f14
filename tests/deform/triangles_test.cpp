#include <nendo/deform/triangles.hpp>

#include <cmath>
#include <numbers>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace triangles_test {

using namespace nendo::deform;

TEST_SUITE("triangles") {
  TEST_CASE("a polygon becomes triangles that face its way and have its area") {
    for (std::uint32_t corners = 3; corners <= 9; ++corners) {
      CAPTURE(corners);
      Mesh mesh;
      mesh.vertices.resize(3, corners);
      for (std::uint32_t at = 0; at < corners; ++at) {
        const double turn = 2.0 * std::numbers::pi * at / corners;
        mesh.vertices.col(at) << std::cos(turn), std::sin(turn), 0.0;
        mesh.face_corners.push_back(at);
      }
      mesh.face_starts.push_back(corners);
      double area = 0.0;
      std::size_t triangles = 0;
      for_each_triangle(mesh, [&](const std::array<std::uint32_t, 3>& triangle) {
        const Eigen::Vector3d a = mesh.vertices.col(triangle[0]);
        const Eigen::Vector3d b = mesh.vertices.col(triangle[1]);
        const Eigen::Vector3d c = mesh.vertices.col(triangle[2]);
        CHECK((b - a).cross(c - a).z() > 0.0);
        area += (b - a).cross(c - a).z() / 2.0;
        ++triangles;
      });
      CHECK(triangles == corners - 2);
      CHECK(area == doctest::Approx(corners / 2.0 * std::sin(2.0 * std::numbers::pi / corners)));
    }
  }

  TEST_CASE("faces of fewer corners have none, and those of others keep their order") {
    Mesh mesh;
    mesh.vertices = Points::Zero(3, 6);
    nendo::test::add_face(mesh, {4, 5});
    nendo::test::add_face(mesh, {3, 1, 2});
    nendo::test::add_face(mesh, {});
    nendo::test::add_face(mesh, {0});
    nendo::test::add_face(mesh, {5, 4, 3, 2});
    CHECK(corners_of_triangles(mesh) == std::vector<std::uint32_t>{3, 1, 2, 5, 4, 3, 5, 3, 2});
    CHECK(corners_of_triangles(Mesh{}).empty());
  }
}

} // namespace triangles_test
