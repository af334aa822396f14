#include <nendo/deform/closed_manifold.hpp>

#include <algorithm>
#include <filesystem>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/test_meshes.hpp"

namespace closed_manifold_test {

using namespace nendo::deform;
using nendo::test::add_face;

Mesh tetrahedron() {
  Mesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  add_face(mesh, {0, 2, 1});
  add_face(mesh, {0, 1, 3});
  add_face(mesh, {1, 2, 3});
  add_face(mesh, {2, 0, 3});
  return mesh;
}

/// Appends another mesh, with its vertices' numbers behind those that are there.
void append(Mesh& mesh, const Mesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.cols());
  mesh.vertices.conservativeResize(3, mesh.vertices.cols() + more.vertices.cols());
  mesh.vertices.rightCols(more.vertices.cols()) = more.vertices;
  for (std::size_t face = 0; face < more.face_count(); ++face) {
    for (std::uint32_t at = more.face_starts[face]; at < more.face_starts[face + 1]; ++at)
      mesh.face_corners.push_back(more.face_corners[at] + first);
    mesh.face_starts.push_back(static_cast<std::uint32_t>(mesh.face_corners.size()));
  }
}

TEST_SUITE("closed manifold") {
  TEST_CASE("closed surfaces pass, of triangles and of polygons, in one part or several") {
    CHECK(check_closed_manifold(tetrahedron()));
    CHECK(check_closed_manifold(nendo::test::sphere(5, 9, 1.0)));
    Mesh two = tetrahedron();
    append(two, nendo::test::sphere(3, 5, 1.0));
    CHECK(check_closed_manifold(two));
    CHECK(describe(check_closed_manifold(two), two).empty());
    for (const char* name : {"moai.obj", "spot.obj"}) {
      const auto model = read_mesh(std::filesystem::path(NENDO_MODELS) / name);
      REQUIRE(model);
      CHECK(check_closed_manifold(*model));
    }
  }

  TEST_CASE("each fault is named with its place") {
    Mesh mesh = tetrahedron();
    SUBCASE("no faces") {
      mesh.face_starts = {0};
      mesh.face_corners.clear();
      CHECK(check_closed_manifold(mesh).fault == ManifoldFault::no_faces);
    }
    SUBCASE("a face is missing: three edges are open") {
      mesh.face_starts.pop_back();
      mesh.face_corners.resize(9);
      const ManifoldCheck check = check_closed_manifold(mesh);
      CHECK(check.fault == ManifoldFault::open_edge);
      CHECK(check.count == 3);
      CHECK(describe(check, mesh) ==
            "is open at the edge between (0, 0, 0) and (0, 1, 0), and at 2 others");
    }
    SUBCASE("a face is turned: its three edges have faces that face opposite ways") {
      std::swap(mesh.face_corners[0], mesh.face_corners[1]);
      const ManifoldCheck check = check_closed_manifold(mesh);
      CHECK(check.fault == ManifoldFault::turned_faces);
      CHECK(check.count == 3);
    }
    SUBCASE("two tetrahedra that share an edge") {
      mesh.vertices.conservativeResize(3, 6);
      mesh.vertices.rightCols(2) << -1, 0, 0, 0, 0, -1;
      add_face(mesh, {0, 4, 1});
      add_face(mesh, {0, 1, 5});
      add_face(mesh, {1, 4, 5});
      add_face(mesh, {4, 0, 5});
      const ManifoldCheck check = check_closed_manifold(mesh);
      CHECK(check.fault == ManifoldFault::crowded_edge);
      CHECK(check.count == 1);
      CHECK(std::minmax(check.from, check.to) ==
            std::pair<const std::uint32_t&, const std::uint32_t&>(0U, 1U));
    }
    SUBCASE("two tetrahedra that share a vertex") {
      Mesh other = tetrahedron();
      append(mesh, other);
      std::replace(mesh.face_corners.begin(), mesh.face_corners.end(), 7U, 3U);
      const ManifoldCheck check = check_closed_manifold(mesh);
      CHECK(check.fault == ManifoldFault::pinched_vertex);
      CHECK(check.from == 3);
      CHECK(check.count == 1);
      CHECK(describe(check, mesh) == "has faces that touch only at the vertex (0, 0, 1)");
    }
    SUBCASE("a corner twice, and too few corners") {
      add_face(mesh, {1, 2, 1});
      CHECK(check_closed_manifold(mesh).fault == ManifoldFault::repeated_corner);
      CHECK(check_closed_manifold(mesh).face == 4);
      mesh = tetrahedron();
      add_face(mesh, {1, 2});
      CHECK(check_closed_manifold(mesh).fault == ManifoldFault::few_corners);
    }
    SUBCASE("a face of another surface twice") {
      add_face(mesh, {0, 2, 1});
      CHECK(check_closed_manifold(mesh).fault == ManifoldFault::crowded_edge);
    }
  }

  TEST_CASE("a head that is open at the neck is refused") {
    const auto model = read_mesh(std::filesystem::path(NENDO_MODELS) / "head.obj");
    REQUIRE(model);
    CHECK(check_closed_manifold(*model).fault == ManifoldFault::open_edge);
  }
}

} // namespace closed_manifold_test
