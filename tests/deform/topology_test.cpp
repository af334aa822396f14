// Clay that becomes thin, judged by counts, volumes and the exact test for faces that meet.

#include <nendo/deform/topology.hpp>

#include <array>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>

#include "support/nasty_meshes.hpp"
#include "support/self_intersections.hpp"
#include "support/test_meshes.hpp"
#include "support/thin_meshes.hpp"

namespace topology_test {

using namespace nendo;
using namespace nendo::deform;
using Eigen::Vector3d;

namespace {

/// V - E + F of a closed mesh of triangles.
long euler_of(const Mesh& mesh) {
  const auto faces = static_cast<long>(mesh.face_count());
  return static_cast<long>(mesh.vertices.cols()) - faces / 2;
}

void check_sound(const Mesh& mesh) {
  CHECK(check_closed_manifold(mesh));
  CHECK(test::count_self_intersections(mesh) == 0);
}

} // namespace

TEST_SUITE("topology") {
  TEST_CASE("a thick model stays as it is, bit for bit") {
    for (const Mesh& mesh :
         {test::sphere(16, 24, 1.0), test::cube_of_cells(6), test::torus(40, 20)}) {
      const auto same = change_topology(mesh);
      REQUIRE(same);
      CHECK(same->counts.all() == 0);
      CHECK(same->mesh.vertices == mesh.vertices);
      CHECK(same->mesh.face_corners == mesh.face_corners);
      CHECK(count_thin_places(mesh) == 0);
    }
  }

  TEST_CASE("a neck of three edges parts, and both ends are closed") {
    const Mesh mesh = test::hourglass(0.2);
    REQUIRE(check_closed_manifold(mesh));
    CHECK(count_thin_places(mesh) > 0);
    const auto parted = change_topology(mesh);
    REQUIRE(parted);
    CHECK(parted->counts.parted == 1);
    CHECK(parted->counts.holes + parted->counts.fused == 0);
    check_sound(parted->mesh);
    const auto parts = separate(parted->mesh);
    REQUIRE(parts.size() == 2);
    CHECK(euler_of(parts[0]) == 2);
    CHECK(euler_of(parts[1]) == 2);
    CHECK(volume_of(parted->mesh) == doctest::Approx(volume_of(mesh)).epsilon(0.02));
    CHECK(finite_box_of(parts[0].vertices).highest.y() <
          finite_box_of(parts[1].vertices).lowest.y());      // apart
    CHECK(change_topology(parted->mesh)->counts.all() == 0); // and they do not fuse again
  }

  TEST_CASE("a hole that becomes as narrow as an edge is closed, and a wider one stays") {
    for (const double narrow : {0.1, 0.5}) {
      CAPTURE(narrow);
      Mesh ring = test::torus(3, 24); // its hole is 0.65 wide
      for (auto column : ring.vertices.colwise())
        column.head<2>() *= 1.0 - (0.65 - narrow) / column.head<2>().norm();
      ring.detail.assign(static_cast<std::size_t>(ring.vertices.cols()), {0.3F, false});
      REQUIRE(euler_of(ring) == 0);
      check_sound(ring);
      const auto closed = change_topology(ring);
      REQUIRE(closed);
      check_sound(closed->mesh);
      const bool is_narrow = narrow < 0.3;
      CHECK(closed->counts.all() == (is_narrow ? 1 : 0));
      CHECK(euler_of(closed->mesh) == (is_narrow ? 2 : 0));
      CHECK(separate(closed->mesh).size() == 1);
      CHECK(volume_of(closed->mesh) == doctest::Approx(volume_of(ring)).epsilon(0.05));
    }
  }

  TEST_CASE("a neck that is not thin stays, and so does what would be a crumb") {
    CHECK(change_topology(test::hourglass(2.0))->counts.all() == 0);
    Mesh bump = test::sphere(16, 24, 1.0); // with a vertex of three faces on it
    const std::array<std::uint32_t, 3> face{bump.face_corners[0], bump.face_corners[1],
                                            bump.face_corners[2]};
    const auto tip = static_cast<std::uint32_t>(bump.vertices.cols());
    bump.vertices.conservativeResize(3, tip + 1);
    bump.vertices.col(tip) =
        1.02 *
        (bump.vertices.col(face[0]) + bump.vertices.col(face[1]) + bump.vertices.col(face[2])) /
        3.0;
    bump.face_corners[2] = tip;
    for (const auto& corners :
         {std::array{face[1], face[2], tip}, std::array{face[2], face[0], tip}}) {
      bump.face_corners.insert(bump.face_corners.end(), corners.begin(), corners.end());
      bump.face_starts.push_back(static_cast<std::uint32_t>(bump.face_corners.size()));
    }
    REQUIRE(check_closed_manifold(bump));
    CHECK(count_thin_places(bump) > 0);
    CHECK(change_topology(bump)->counts.all() == 0);
  }

  TEST_CASE("a wall that becomes thin gets a hole, which is a handle") {
    const Mesh plate = test::dented_plate(0.4, 0.01);
    REQUIRE(check_closed_manifold(plate));
    const auto opened = change_topology(plate);
    REQUIRE(opened);
    CHECK(opened->counts.holes == 1);
    CHECK(opened->counts.parted + opened->counts.fused == 0);
    check_sound(opened->mesh);
    CHECK(separate(opened->mesh).size() == 1);
    CHECK(euler_of(opened->mesh) == 0); // as a torus
    CHECK(volume_of(opened->mesh) == doctest::Approx(volume_of(plate)).epsilon(0.01));
    CHECK(change_topology(test::dented_plate(0.4, 0.2))->counts.all() == 0);
  }

  TEST_CASE("balls that come near each other fuse, and one that touches itself closes a ring") {
    Mesh balls = test::cube_of_cells(8);
    Mesh other = balls;
    other.vertices.row(0).array() += 1.0 + 0.01;
    other.vertices.row(1).array() += 0.01;
    const auto count = static_cast<std::uint32_t>(balls.vertices.cols());
    balls.vertices.conservativeResize(3, 2 * count);
    balls.vertices.rightCols(count) = other.vertices;
    for (std::size_t face = 0; face < other.face_count(); ++face) {
      for (std::uint32_t at = other.face_starts[face]; at < other.face_starts[face + 1]; ++at)
        balls.face_corners.push_back(count + other.face_corners[at]);
      balls.face_starts.push_back(static_cast<std::uint32_t>(balls.face_corners.size()));
    }
    const auto fused = change_topology(balls);
    REQUIRE(fused);
    CHECK(fused->counts.fused >= 1);
    CHECK(fused->counts.parted + fused->counts.holes == 0);
    check_sound(fused->mesh);
    CHECK(separate(fused->mesh).size() == 1);
    CHECK(volume_of(fused->mesh) == doctest::Approx(2.0).epsilon(0.01));
  }

  TEST_CASE("what is done to a shape is done to it again, to the same bits") {
    for (const Mesh& mesh : {test::hourglass(0.2), test::dented_plate(0.4, 0.01)}) {
      const auto one = change_topology(mesh), other = change_topology(mesh);
      REQUIRE(one);
      REQUIRE(other);
      CHECK(one->mesh.vertices == other->mesh.vertices);
      CHECK(one->mesh.face_corners == other->mesh.face_corners);
    }
  }

  TEST_CASE(
      "whatever is thin, the surface stays closed, nothing meets, and Euler's count adds up") {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    TopologyCounts seen;
    for (int round = 0; round < 60; ++round) {
      CAPTURE(round);
      Mesh mesh = round % 3 == 0 ? test::hourglass(0.02 + 0.4 * any(random))
                  : round % 3 == 1
                      ? test::dented_plate(0.1 + any(random), 0.005 + 0.03 * any(random))
                      : test::torus(40, 3U + static_cast<std::uint32_t>(round % 4));
      const double noise = 0.003 * any(random);
      for (auto column : mesh.vertices.colwise())
        column += noise * Vector3d(any(random) - 0.5, any(random) - 0.5, any(random) - 0.5);
      const Eigen::Vector3d axis = Vector3d(any(random), 1.0, any(random)).normalized();
      const Eigen::Matrix3d turn = Eigen::AngleAxisd(3.0 * any(random), axis).toRotationMatrix();
      mesh.vertices = (turn * mesh.vertices).eval();
      if (test::count_self_intersections(mesh) > 0) continue;
      for (int again = 0; again < 3; ++again) {
        const auto changed = change_topology(mesh);
        REQUIRE(changed);
        const TopologyCounts& counts = changed->counts;
        check_sound(changed->mesh);
        CHECK(euler_of(changed->mesh) == euler_of(mesh) + 2 * static_cast<long>(counts.parted) -
                                             2 * static_cast<long>(counts.holes + counts.fused));
        seen.parted += counts.parted;
        seen.holes += counts.holes;
        mesh = changed->mesh;
        if (counts.all() == 0) break;
      }
    }
    CHECK(seen.parted > 5);
    CHECK(seen.holes > 5);
  }

  TEST_CASE("looks and lengths of edges follow, and all else keeps its bits") {
    Mesh plate = test::dented_plate(0.4, 0.01);
    const Eigen::Index count = plate.vertices.cols();
    plate.look.vertex_colours = Eigen::Matrix4Xf::Random(4, count);
    plate.look.materials.resize(1);
    plate.look.materials[0].name = "clay";
    plate.look.face_materials.assign(plate.face_count(), 0);
    plate.detail.assign(static_cast<std::size_t>(count), VertexDetail{0.07F, false});
    const auto opened = change_topology(plate);
    REQUIRE(opened);
    REQUIRE(opened->counts.all() > 0);
    const Mesh& mesh = opened->mesh;
    CHECK(mesh.detail.size() == static_cast<std::size_t>(mesh.vertices.cols()));
    CHECK(mesh.look.face_materials.size() == mesh.face_count());
    Eigen::Index old = 0;
    for (Eigen::Index at = 0; at < mesh.vertices.cols(); ++at) {
      while (old < count && plate.vertices.col(old) != mesh.vertices.col(at))
        ++old;
      REQUIRE(old < count); // a hole makes no vertex
      CHECK(plate.look.vertex_colours.col(old) == mesh.look.vertex_colours.col(at));
    }
  }

  TEST_CASE("what is not closed or not finite is refused") {
    Mesh open = test::sphere(9, 16, 1.0);
    open.face_starts.pop_back();
    open.face_corners.resize(open.face_starts.back());
    CHECK(change_topology(open).error().code == Errc::bad_input);
    CHECK(count_thin_places(open) == 0);
    Mesh strange = test::sphere(9, 16, 1.0);
    strange.vertices(1, 3) = std::numeric_limits<double>::quiet_NaN();
    CHECK(change_topology(strange).error().code == Errc::bad_input);
    CHECK(count_thin_places(strange) == 0);
  }
}

} // namespace topology_test
