#include <nendo/deform/offset.hpp>

#include <array>
#include <cmath>

#include <doctest/doctest.h>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/edit_part.hpp>
#include <nendo/deform/join.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/refinement.hpp>
#include <nendo/deform/subdivision.hpp>
#include <nendo/deform/topology.hpp>

#include "reference/icosphere.hpp"
#include "support/placed_meshes.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

namespace offset_test {

using namespace nendo;
using namespace nendo::deform;
using Eigen::Vector3d;

namespace {

Mesh counted(Mesh mesh) {
  count_from(usual_offset(mesh), mesh);
  return mesh;
}

Points in_file(const Mesh& mesh) {
  return mesh.vertices.colwise() + mesh.offset;
}

} // namespace

TEST_SUITE("offset") {
  TEST_CASE("models near zero stay as they are, whatever their unit") {
    for (const double size : {1e-3, 1.0, 1e4})
      for (const Vector3d& away : {Vector3d(0, 0, 0), Vector3d(1, -1, 0.5), Vector3d(3.9, 0, -3.9)})
        CHECK(
            usual_offset(test::moved(reference::icosphere(1, size / 2), size * away)).isZero(0.0));
    CHECK(usual_offset(Mesh{}).isZero(0.0));
    Mesh point;
    point.vertices = Vector3d(5, 6, 7);
    CHECK(usual_offset(point).isZero(0.0));
  }

  TEST_CASE("far models count from their middle, and come back to the bit") {
    for (const double size : {1e-3, 1.0, 1e4})
      for (const double away : {1.0, 1e3, 1e4, 5e5, 1e7}) {
        if (away <= 4.0 * size) continue;
        CAPTURE(size);
        CAPTURE(away);
        const Mesh mesh = test::moved(reference::icosphere(2, size / 2), {away, 0.0, -away});
        const Mesh near = counted(mesh);
        CHECK(near.vertices.cwiseAbs().maxCoeff() <= 0.51 * size);
        CHECK(near.offset.y() == 0.0);
        CHECK((near.offset - Vector3d(away, 0.0, -away)).norm() <= 1e-3 * size);
        CHECK(in_file(near) == mesh.vertices);
        Mesh back = near;
        count_from(Vector3d::Zero(), back);
        CHECK(back.vertices == mesh.vertices);
        CHECK(back.offset.isZero(0.0));
        CHECK(usual_offset(near) == near.offset); // it is of the file, wherever one counts from
      }
  }

  TEST_CASE("a stray vertex decides nothing") {
    Mesh mesh = test::moved(reference::icosphere(1, 1.0), {5e5, 4.6e6, 0.0});
    mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 1);
    mesh.vertices.rightCols(1).setZero();
    CHECK((usual_offset(mesh) - Vector3d(5e5, 4.6e6, 0.0)).norm() < 1e-3);
  }

  TEST_CASE("what is written has the file's coordinates") {
    const test::TemporaryFolder folder;
    const Mesh mesh = test::moved(reference::icosphere(2, 1.0), {500123.25, 4649776.5, 312.75});
    const Mesh near = counted(mesh);
    for (const std::string name : {"a.obj", "a.ply"}) {
      const auto path = folder.path() / name;
      REQUIRE(write_mesh(path, near));
      const auto read = read_mesh(path);
      REQUIRE(read);
      CHECK(read->vertices == mesh.vertices);
    }
  }

  TEST_CASE("whatever is made of a model is where the model is") {
    const Vector3d away(1e6, -2e6, 3e5);
    const Mesh mesh = counted(test::moved(reference::icosphere(2, 1.0), away));
    REQUIRE_FALSE(mesh.offset.isZero(0.0));
    CHECK(subdivide(mesh).mesh.offset == mesh.offset);
    const auto refiner = Refiner::make(mesh);
    REQUIRE(refiner);
    const BlockLayout layout(mesh.vertices);
    CHECK(refiner->refine(layout.pack(), layout, {.max_vertices = 10000}).mesh.offset ==
          mesh.offset);
    const auto again = refined(mesh, {});
    REQUIRE(again);
    CHECK(again->offset == mesh.offset);
    const auto topology = change_topology(mesh);
    REQUIRE(topology);
    CHECK(topology->mesh.offset == mesh.offset);
    const auto cut = cut_model(mesh, CutPlane{Vector3d(0.1, 0.0, 0.0), Vector3d(1.0, 0.2, 0.1)});
    REQUIRE(cut);
    CHECK(cut->parts == 2);
    CHECK(cut->mesh.offset == mesh.offset);
    for (const Mesh& part : separate(*cut))
      CHECK(part.offset == mesh.offset);
    const auto both = copied_part(mesh, 0);
    REQUIRE(both);
    CHECK(both->offset == mesh.offset);
    const auto one = removed_part(*both, 1);
    REQUIRE(one);
    CHECK(one->offset == mesh.offset);
    CHECK((in_file(*one) - in_file(mesh)).cwiseAbs().maxCoeff() == 0.0);
  }

  TEST_CASE("parts that count from other places join where they are") {
    const Vector3d away(4e5, 0.0, 7e6);
    const Mesh left = counted(test::moved(reference::icosphere(2, 1.0), away));
    const Mesh right =
        counted(test::moved(reference::icosphere(2, 1.0), away + Vector3d(0.9, 0.1, 0.2)));
    REQUIRE(left.offset != right.offset);
    const std::array parts{JoinPart{&left, "left"}, JoinPart{&right, "right"}};
    const auto joined = join(parts, {});
    REQUIRE(joined);
    const Mesh at_zero = reference::icosphere(2, 1.0);
    const Mesh beside = test::moved(at_zero, {0.9, 0.1, 0.2});
    const std::array near{JoinPart{&at_zero, "left"}, JoinPart{&beside, "right"}};
    const auto there = join(near, {});
    REQUIRE(there);
    CHECK(volume_of(joined->mesh) == doctest::Approx(volume_of(there->mesh)).epsilon(1e-8));
    const Box box = finite_box_of(in_file(joined->mesh));
    CHECK((box.lowest - away - finite_box_of(there->mesh.vertices).lowest).norm() < 1e-8);
    const std::array all{left, right};
    const auto row = side_by_side(all);
    REQUIRE(row);
    CHECK(row->offset == left.offset);
  }
}

} // namespace offset_test
