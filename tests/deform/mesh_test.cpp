#include <nendo/deform/mesh.hpp>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace mesh_test {

using namespace nendo::deform;

TEST_SUITE("mesh") {
  TEST_CASE("the diagonal is that of the bounding box") {
    CHECK(diagonal_of(Points(3, 0)) == 0.0);
    CHECK(diagonal_of(Points::Constant(3, 1, 7.0)) == 0.0);
    CHECK(diagonal_of(nendo::test::grid(4, 3.0).vertices) == doctest::Approx(3.0 * std::sqrt(2.0)));
    Points huge = Points::Zero(3, 2);
    huge.col(1) << 3e200, 4e200, 0.0;
    CHECK(diagonal_of(huge) == doctest::Approx(5e200));
  }

  TEST_CASE("normals of a sphere point outward, of whatever size it is") {
    for (const double radius : {1e-120, 1.0, 1e90}) {
      const Mesh mesh = nendo::test::sphere(15, 24, radius);
      const Points normals = vertex_normals(mesh);
      CHECK((normals - mesh.vertices / radius).colwise().norm().maxCoeff() < 0.06);
    }
  }

  TEST_CASE("a large face outweighs a small one") {
    Mesh mesh;
    mesh.vertices.resize(3, 5);
    mesh.vertices << 0, 1, 0, 0, 0, //
        0, 0, 1, 2, 0,              //
        0, 0, 0, 0, 6;
    nendo::test::add_face(mesh, {0, 1, 2}); // area 1/2 along z
    nendo::test::add_face(mesh, {0, 3, 4}); // area 6 along x
    CHECK(vertex_normals(mesh).col(0).isApprox(Eigen::Vector3d(12, 0, 1).normalized()));
  }

  TEST_CASE("a vertex without a face of any area has no normal") {
    Mesh mesh = nendo::test::grid(1, 1.0);
    mesh.vertices.conservativeResize(3, 5);
    mesh.vertices.col(4) << 5, 5, 5;
    nendo::test::add_face(mesh, {4, 4, 4});
    CHECK(vertex_normals(mesh).col(4).isZero(0.0));
    CHECK(vertex_normals(Mesh{}).cols() == 0);
  }
}

} // namespace mesh_test
