// A subdivided mesh is the same surface, with more vertices; a shape of the mesh before means one
// of the subdivided mesh.

#include <nendo/deform/subdivision.hpp>

#include <map>
#include <random>
#include <set>
#include <utility>

#include <Eigen/Geometry>

#include <doctest/doctest.h>

#include <nendo/deform/triangles.hpp>

#include "support/fields.hpp"
#include "support/test_meshes.hpp"

namespace subdivision_test {

using namespace nendo::deform;

namespace {

using Edges = std::map<std::pair<std::uint32_t, std::uint32_t>, int>;

/// How often each edge is in a face.
Edges edges_of(const Mesh& mesh) {
  Edges edges;
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    const std::uint32_t begin = mesh.face_starts[face], end = mesh.face_starts[face + 1];
    for (std::uint32_t at = begin; at < end; ++at) {
      const std::uint32_t next = at + 1 < end ? at + 1 : begin;
      ++edges[std::minmax(mesh.face_corners[at], mesh.face_corners[next])];
    }
  }
  return edges;
}

double area_of(const Mesh& mesh) {
  double area = 0.0;
  for_each_triangle(mesh, [&](const auto& corner) {
    const auto at = [&](int of) -> Eigen::Vector3d {
      return mesh.vertices.col(static_cast<Eigen::Index>(corner[static_cast<std::size_t>(of)]));
    };
    area += (at(1) - at(0)).cross(at(2) - at(0)).norm() / 2.0;
  });
  return area;
}

Mesh as_triangles(const Mesh& mesh) {
  Mesh triangles;
  triangles.vertices = mesh.vertices;
  for_each_triangle(mesh, [&](const auto& corner) {
    nendo::test::add_face(triangles, {corner[0], corner[1], corner[2]});
  });
  return triangles;
}

long euler(const Mesh& mesh) {
  return static_cast<long>(mesh.vertices.cols()) - static_cast<long>(edges_of(mesh).size()) +
         static_cast<long>(mesh.face_count());
}

} // namespace

TEST_CASE("deform/subdivision/a closed surface stays closed, and the same one") {
  for (const bool triangles : {false, true}) {
    const Mesh ball = nendo::test::sphere(9, 14, 3.0);
    const Mesh mesh = triangles ? as_triangles(ball) : ball;
    const Subdivision finer = subdivide(mesh);
    std::size_t many = 0; // faces with more than three corners
    for (std::size_t face = 0; face < mesh.face_count(); ++face)
      many += mesh.face_starts[face + 1] - mesh.face_starts[face] > 3 ? 1U : 0U;
    const auto old = static_cast<std::size_t>(mesh.vertices.cols());
    REQUIRE(static_cast<std::size_t>(finer.mesh.vertices.cols()) ==
            old + edges_of(mesh).size() + many);
    CHECK(finer.mesh.face_count() == (triangles
                                          ? 4 * mesh.face_count()
                                          : mesh.face_corners.size() + (mesh.face_count() - many)));
    CHECK(euler(finer.mesh) == euler(mesh));
    for (const auto& [ends, count] : edges_of(finer.mesh))
      REQUIRE(count == 2);
    CHECK(finer.mesh.vertices.leftCols(mesh.vertices.cols()) == mesh.vertices);
    REQUIRE(finer.parent_starts.size() ==
            static_cast<std::size_t>(finer.mesh.vertices.cols()) - old + 1);
    for (std::size_t k = 0; k + 1 < finer.parent_starts.size(); ++k) {
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      for (std::uint32_t of = finer.parent_starts[k]; of < finer.parent_starts[k + 1]; ++of)
        sum += mesh.vertices.col(static_cast<Eigen::Index>(finer.parents[of]));
      const double count = finer.parent_starts[k + 1] - finer.parent_starts[k];
      const auto vertex = static_cast<Eigen::Index>(old + k);
      REQUIRE((finer.mesh.vertices.col(vertex) - sum / count).norm() < 1e-14);
    }
  }
  const Mesh triangles = as_triangles(nendo::test::sphere(9, 14, 3.0));
  CHECK(area_of(subdivide(triangles).mesh) == doctest::Approx(area_of(triangles)).epsilon(1e-12));
}

TEST_CASE("deform/subdivision/faces keep their sides") {
  const Mesh finer = subdivide(nendo::test::sphere(9, 14, 3.0)).mesh;
  for_each_triangle(finer, [&](const auto& corner) {
    const auto at = [&](std::size_t of) -> Eigen::Vector3d {
      return finer.vertices.col(static_cast<Eigen::Index>(corner[of]));
    };
    REQUIRE((at(1) - at(0)).cross(at(2) - at(0)).dot(at(0)) > 0.0); // outwards
  });
}

TEST_CASE("deform/subdivision/texture coordinates follow, also along a seam") {
  Mesh mesh = nendo::test::grid(2, 1.0);
  const auto corners = static_cast<Eigen::Index>(mesh.face_corners.size());
  mesh.texcoords.resize(2, corners); // each corner has its own: every edge is a seam
  for (Eigen::Index at = 0; at < corners; ++at) {
    const auto vertex = static_cast<Eigen::Index>(mesh.face_corners[static_cast<std::size_t>(at)]);
    mesh.texcoords.col(at) = mesh.vertices.col(vertex).head<2>() * 0.5;
    mesh.corner_texcoords.push_back(static_cast<std::uint32_t>(at));
  }
  const Mesh finer = subdivide(mesh).mesh;
  REQUIRE(finer.corner_texcoords.size() == finer.face_corners.size());
  for (std::size_t at = 0; at < finer.face_corners.size(); ++at) {
    const auto vertex = static_cast<Eigen::Index>(finer.face_corners[at]);
    const auto texcoord = static_cast<Eigen::Index>(finer.corner_texcoords[at]);
    CHECK((finer.texcoords.col(texcoord) - finer.vertices.col(vertex).head<2>() * 0.5).norm() <
          1e-15);
  }
}

TEST_CASE("deform/subdivision/points, lines and what is not finite do no harm") {
  Mesh mesh = nendo::test::grid(1, 1.0);
  nendo::test::add_face(mesh, {0, 1});
  nendo::test::add_face(mesh, {2});
  mesh.vertices(0, 3) = std::numeric_limits<double>::quiet_NaN();
  mesh.vertices(1, 2) = 1e308;
  mesh.vertices(1, 0) = 1e308;
  const Subdivision finer = subdivide(mesh);
  CHECK(finer.mesh.face_count() == 4 + 2);
  CHECK(finer.mesh.vertices.cols() == 4 + 4 + 1);
  const BlockLayout before(mesh.vertices), after(finer.mesh.vertices);
  CHECK(before.unit() == after.unit());
  Points shape;
  after.unpack(subdivided(before.pack(), before, finer, after), shape);
  for (Eigen::Index at = 0; at < shape.size(); ++at)
    if (std::isfinite(finer.mesh.vertices.data()[at]))
      CHECK(shape.data()[at] == finer.mesh.vertices.data()[at]);
  CHECK(subdivide(Mesh{}).mesh.vertices.cols() == 0);
}

TEST_CASE("deform/subdivision/a shape means one of the subdivided mesh") {
  const Mesh mesh = nendo::test::sphere(20, 30, 5.0);
  const Subdivision finer = subdivide(mesh);
  const BlockLayout before(mesh.vertices), after(finer.mesh.vertices);
  REQUIRE(before.origin() == after.origin());

  Points unmoved;
  after.unpack(subdivided(before.pack(), before, finer, after), unmoved);
  CHECK(unmoved == finer.mesh.vertices); // to the last bit

  std::mt19937 random{3};
  const Points moved =
      mesh.vertices + nendo::test::random_points(random, mesh.vertices.cols(), 0.3);
  BlockShape shape = before.pack();
  for (std::size_t at = 0; at < before.vertex_count(); ++at) {
    const Eigen::Vector3f place =
        ((moved.col(static_cast<Eigen::Index>(before.order()[at])) - before.origin()) /
         before.unit())
            .cast<float>();
    VertexBlock& block = shape.data()[at / block_size];
    block.x[at % block_size] = place[0];
    block.y[at % block_size] = place[1];
    block.z[at % block_size] = place[2];
  }
  Points old, shown;
  before.unpack(shape, old);
  after.unpack(subdivided(shape, before, finer, after), shown);
  CHECK(shown.leftCols(old.cols()) == old);
  for (std::size_t k = 0; k + 1 < finer.parent_starts.size(); ++k) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (std::uint32_t of = finer.parent_starts[k]; of < finer.parent_starts[k + 1]; ++of)
      sum += moved.col(static_cast<Eigen::Index>(finer.parents[of]));
    const double count = finer.parent_starts[k + 1] - finer.parent_starts[k];
    const auto vertex = mesh.vertices.cols() + static_cast<Eigen::Index>(k);
    REQUIRE((shown.col(vertex) - sum / count).norm() < 5e-6);
  }
}

} // namespace subdivision_test
