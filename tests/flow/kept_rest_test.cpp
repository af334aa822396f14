#include <nendo/flow/model_version.hpp>

#include <doctest/doctest.h>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/join.hpp>

#include "support/test_meshes.hpp"

namespace kept_rest_test {

using namespace nendo;
using deform::Mesh;
using deform::Points;
using Eigen::Index;
using Eigen::Vector3d;

namespace {

/// By which a shape is made of a rest: linear, so that what lies on an edge stays on it.
const Eigen::Matrix3d stretch = Vector3d(1.25, 0.75, 1.0).asDiagonal();

Mesh shaped_of(const Mesh& rest) {
  Mesh shaped = rest;
  shaped.vertices = stretch * rest.vertices;
  return shaped;
}

} // namespace

TEST_SUITE("kept_rest") {
  TEST_CASE("what a cut adds rests where the shape's way back leads, the rest has its bits") {
    const Mesh rest = test::sphere(20, 40, 1.0);
    const Mesh shaped = shaped_of(rest);
    const auto made = deform::cut_model(
        shaped, deform::CutPlane{Vector3d(0.0, 0.0, 0.21), Vector3d(0.1, 0.2, 1.0)});
    REQUIRE(made);
    const Points kept = flow::kept_rest(made->mesh, shaped.vertices, rest.vertices);
    const Index old = rest.vertices.cols();
    REQUIRE(kept.cols() > old);
    CHECK(kept.leftCols(old) == rest.vertices);
    for (Index vertex = old; vertex < kept.cols(); ++vertex) {
      const Vector3d exact = stretch.inverse() * made->mesh.vertices.col(vertex);
      REQUIRE((kept.col(vertex) - exact).norm() < 0.06);
    }
  }

  TEST_CASE("vertices are known by their places where others were taken away before them") {
    Mesh rest = test::sphere(12, 24, 1.0);
    const Mesh shaped = shaped_of(rest);
    Mesh moved = shaped;
    moved.vertices.colwise() += Vector3d(0.9, 0.1, 0.05);
    const deform::JoinPart parts[] = {{&moved, "one"}, {&shaped, "other"}};
    const auto made = deform::join(parts, {});
    REQUIRE(made);
    const Points kept = flow::kept_rest(made->mesh, shaped.vertices, rest.vertices);
    int known = 0;
    for (Index vertex = 0; vertex < kept.cols(); ++vertex)
      for (Index old = 0; old < rest.vertices.cols(); ++old)
        if (made->mesh.vertices.col(vertex) == shaped.vertices.col(old)) {
          ++known;
          REQUIRE(kept.col(vertex) == rest.vertices.col(old));
        }
    CHECK(known > 100);
    CHECK(kept.allFinite());
  }

  TEST_CASE("a part of which nothing was there before rests where it is") {
    const Mesh rest = test::sphere(6, 12, 1.0);
    Mesh made = rest;
    made.vertices.colwise() += Vector3d(5.0, 0.0, 0.0);
    const Points kept = flow::kept_rest(made, shaped_of(rest).vertices, rest.vertices);
    CHECK(kept == made.vertices);
    CHECK(flow::kept_rest(Mesh{}, rest.vertices, rest.vertices).cols() == 0);
  }
}

} // namespace kept_rest_test
