#include <nendo/deform/repair.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "support/nasty_meshes.hpp"

namespace repair_test {

using namespace nendo::deform;
using namespace nendo::test;

/// Each face gets vertices of its own, as in formats without shared vertices.
Mesh unshared(const Mesh& mesh) {
  Mesh loose = mesh;
  loose.vertices.resize(3, static_cast<Eigen::Index>(mesh.face_corners.size()));
  for (std::uint32_t at = 0; at < mesh.face_corners.size(); ++at) {
    loose.vertices.col(at) = mesh.vertices.col(mesh.face_corners[at]);
    loose.face_corners[at] = at;
  }
  return loose;
}

Mesh without_faces(const Mesh& mesh, std::size_t first, std::size_t count) {
  Mesh open = mesh;
  open.face_starts = {0};
  open.face_corners.clear();
  for (std::size_t face = 0; face < mesh.face_count(); ++face) {
    if (face >= first && face < first + count) continue;
    for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at)
      open.face_corners.push_back(mesh.face_corners[at]);
    open.face_starts.push_back(static_cast<std::uint32_t>(open.face_corners.size()));
  }
  return open;
}

TEST_SUITE("repair") {
  TEST_CASE("vertices in one place are joined, and turned faces turn back") {
    for (const Mesh& whole : {torus(20, 10), cube_of_cells(3, true), comb(5)}) {
      Mesh broken = unshared(whole);
      for (std::size_t face = 0; face < broken.face_count(); face += 3)
        std::reverse(broken.face_corners.begin() + broken.face_starts[face],
                     broken.face_corners.begin() + broken.face_starts[face + 1]);
      CHECK(!check_closed_manifold(broken));
      const auto mended = repair(broken);
      REQUIRE(mended);
      CHECK(check_closed_manifold(mended->mesh));
      CHECK(volume_of(mended->mesh) == doctest::Approx(volume_of(whole)).epsilon(1e-12));
      CHECK(mended->filled == 0);
      CHECK(mended->mesh.vertices == broken.vertices);
    }
  }

  TEST_CASE("holes are filled: of a cube so that its volume comes back") {
    const Mesh cube = cube_of_cells(4);
    const Mesh open = without_faces(cube, 10, 7);
    const auto mended = repair(open);
    REQUIRE(mended);
    CHECK(mended->filled >= 1);
    CHECK(check_closed_manifold(mended->mesh));
    CHECK(volume_of(mended->mesh) == doctest::Approx(1.0).epsilon(0.05));
    CHECK(volume_of(repair(cube)->mesh) == doctest::Approx(1.0).epsilon(1e-14));
  }

  TEST_CASE("doubles and faces without area are dropped") {
    Mesh mesh = torus(12, 8);
    const std::size_t faces = mesh.face_count();
    add_face(mesh, {mesh.face_corners[0], mesh.face_corners[1], mesh.face_corners[2]});
    add_face(mesh, {3, 4, 4});
    add_face(mesh, {5, 6});
    const auto mended = repair(mesh);
    REQUIRE(mended);
    CHECK(mended->dropped == 3);
    CHECK(mended->mesh.face_count() == faces);
    CHECK(describe(*mended) == "dropped 3 faces");
  }

  TEST_CASE("the shipped head, open at the neck, can be cut when it is repaired") {
    const auto head = read_mesh(std::filesystem::path(NENDO_MODELS) / "head.obj");
    REQUIRE(head);
    const auto mended = repair(*head);
    if (!mended) {
      MESSAGE(mended.error().message);
      CHECK(mended.error().message.starts_with("cannot be repaired: "));
      return;
    }
    CHECK(check_closed_manifold(mended->mesh));
    MESSAGE(describe(*mended));
    const Eigen::Vector3d middle = head->vertices.rowwise().mean();
    CHECK(cut_model(mended->mesh, CutPlane{middle, {0.1, 1.0, 0.2}}));
  }

  TEST_CASE("what cannot be repaired says why") {
    Mesh mesh;
    CHECK(!repair(mesh));
    // Three faces at one edge.
    mesh.vertices.resize(3, 5);
    mesh.vertices << 0, 1, 0, 0, 0, 0, 0, 1, -1, 0, 0, 0, 0, 0, 1;
    add_face(mesh, {0, 1, 2});
    add_face(mesh, {1, 0, 3});
    add_face(mesh, {0, 1, 4});
    const auto mended = repair(mesh);
    REQUIRE(!mended);
    CHECK(mended.error().code == nendo::Errc::bad_input);
    CHECK(mended.error().message.starts_with("cannot be repaired"));
  }
}

} // namespace repair_test
