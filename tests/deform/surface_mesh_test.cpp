// Laws of the triangles that know their neighbours, whatever is done to them.

#include "mesh/surface_mesh.hpp"

#include <algorithm>
#include <array>
#include <random>
#include <set>
#include <vector>

#include <doctest/doctest.h>

#include "mesh/used_entries.hpp"

namespace surface_mesh_test {

using namespace nendo::deform;

namespace {

/// Rings of triangles around a ring.
std::vector<Corners> torus_faces(std::uint32_t around, std::uint32_t across) {
  std::vector<Corners> faces;
  for (std::uint32_t i = 0; i < around; ++i)
    for (std::uint32_t j = 0; j < across; ++j) {
      const auto number = [&](std::uint32_t one, std::uint32_t other) {
        return one % around * across + other % across;
      };
      faces.push_back({number(i, j), number(i + 1, j), number(i + 1, j + 1)});
      faces.push_back({number(i, j), number(i + 1, j + 1), number(i, j + 1)});
    }
  return faces;
}

/// Points 0, 1 and 2 are the ring, 3 and 4 the tips.
std::vector<Corners> bipyramid_faces() {
  return {{0, 1, 3}, {1, 2, 3}, {2, 0, 3}, {1, 0, 4}, {2, 1, 4}, {0, 2, 4}};
}

/// V - E + F of the remaining surface.
long euler_number(const SurfaceMesh& mesh) {
  long count = 0;
  for (std::uint32_t point = 0; point < mesh.point_count(); ++point)
    count += mesh.has_point(point) ? 1 : 0;
  for (std::uint32_t edge = 0; edge < 3 * mesh.face_count(); ++edge) {
    if (!mesh.has_face(edge / 3)) continue;
    count += edge % 3 == 0 ? 1 : 0;
    count -= mesh.twin(edge) == no_index || edge < mesh.twin(edge) ? 1 : 0;
  }
  return count;
}

void check_edges(const SurfaceMesh& mesh) {
  for (std::uint32_t edge = 0; edge < 3 * mesh.face_count(); ++edge) {
    if (!mesh.has_face(edge / 3)) continue;
    REQUIRE(mesh.next(mesh.next(mesh.next(edge))) == edge);
    REQUIRE(mesh.last(mesh.next(edge)) == edge);
    REQUIRE(mesh.to(edge) == mesh.from(mesh.next(edge)));
    REQUIRE(mesh.has_point(mesh.from(edge)));
    const std::uint32_t twin = mesh.twin(edge);
    if (twin == no_index) continue;
    REQUIRE(mesh.has_face(twin / 3));
    REQUIRE(mesh.twin(twin) == edge);
    REQUIRE(mesh.from(twin) == mesh.to(edge));
    REQUIRE(mesh.to(twin) == mesh.from(edge));
  }
}

void check_closed(const SurfaceMesh& mesh) {
  check_edges(mesh);
  std::size_t corners = 0;
  for (std::uint32_t point = 0; point < mesh.point_count(); ++point) {
    if (!mesh.has_point(point)) continue;
    std::set<std::uint32_t> around;
    mesh.visit_edges(point, [&](std::uint32_t edge) {
      REQUIRE(mesh.from(edge) == point);
      REQUIRE(mesh.edge_between(point, mesh.to(edge)) == edge);
      REQUIRE(around.insert(edge).second);
    });
    corners += around.size();
  }
  for (std::uint32_t face = 0; face < mesh.face_count(); ++face)
    corners -= mesh.has_face(face) ? 3U : 0U;
  CHECK(corners == 0); // each is around its point
}

std::size_t count_boundary(const SurfaceMesh& mesh) {
  std::size_t count = 0;
  for (std::uint32_t edge = 0; edge < 3 * mesh.face_count(); ++edge)
    count += mesh.has_face(edge / 3) && mesh.twin(edge) == no_index ? 1U : 0U;
  return count;
}

} // namespace

TEST_SUITE("surface mesh") {
  TEST_CASE("splits, flips and collapses keep edges paired, and Euler's number") {
    std::mt19937 random(5);
    for (const std::uint32_t around : {3U, 8U}) {
      SurfaceMesh mesh(torus_faces(around, 5), around * 5);
      check_closed(mesh);
      std::array<int, 3> done{};
      for (int step = 0; step < 2000; ++step) {
        const auto edge = static_cast<std::uint32_t>(random() % (3 * mesh.face_count()));
        if (!mesh.has_face(edge / 3)) continue;
        const std::uint32_t from = mesh.from(edge), to = mesh.to(edge);
        const std::size_t kind = random() % 3;
        if (kind == 0) {
          const std::uint32_t faces = mesh.face_count();
          const std::uint32_t middle = mesh.split(edge);
          REQUIRE(mesh.from(edge) == from);
          REQUIRE(mesh.to(edge) == middle);
          REQUIRE(mesh.corners(faces)[0] == middle);
          REQUIRE(mesh.corners(faces)[1] == to);
          REQUIRE(mesh.corners(faces + 1)[1] == from);
        } else if (kind == 1 && mesh.can_flip(edge)) {
          mesh.flip(edge);
          REQUIRE(mesh.edge_between(from, to) == no_index);
        } else if (kind == 2 && mesh.can_collapse(edge)) {
          mesh.collapse(edge);
          REQUIRE(mesh.has_point(from));
          REQUIRE_FALSE(mesh.has_point(to));
        } else {
          continue;
        }
        ++done[kind];
        if (step % 50 == 0) check_closed(mesh);
        REQUIRE(euler_number(mesh) == 0);
      }
      CHECK(*std::min_element(done.begin(), done.end()) > 50);
    }
  }

  TEST_CASE("faces that are removed and added again are the surface that there was") {
    const std::vector<Corners> faces = torus_faces(6, 7);
    SurfaceMesh mesh(faces, 42);
    std::mt19937 random(9);
    for (int round = 0; round < 50; ++round) {
      CAPTURE(round);
      std::set<std::uint32_t> some;
      while (some.size() < 10) {
        const auto face = static_cast<std::uint32_t>(random() % mesh.face_count());
        if (mesh.has_face(face)) some.insert(face);
      }
      std::vector<Corners> removed;
      for (const std::uint32_t face : some)
        removed.push_back(mesh.corners(face));
      mesh.remove_faces(std::vector<std::uint32_t>(some.begin(), some.end()));
      check_edges(mesh);
      CHECK(count_boundary(mesh) > 0);
      for (const Corners& corners : removed)
        mesh.add_face(corners);
      check_closed(mesh);
      CHECK(euler_number(mesh) == 0);
    }
    Renumbering numbers;
    std::vector<Corners> left = mesh.take(numbers);
    std::vector<Corners> wanted = faces;
    std::sort(left.begin(), left.end());
    std::sort(wanted.begin(), wanted.end());
    CHECK(left == wanted);
    CHECK(mesh.face_count() == 0);
  }

  TEST_CASE("faces added one by one find their neighbours") {
    SurfaceMesh mesh({}, 5);
    std::size_t boundary = 0;
    for (const Corners& corners : bipyramid_faces()) {
      mesh.add_face(corners);
      check_edges(mesh);
      CHECK(count_boundary(mesh) != boundary);
      boundary = count_boundary(mesh);
    }
    check_closed(mesh);
    CHECK(boundary == 0);
    CHECK(euler_number(mesh) == 2);
  }

  TEST_CASE("a surface that is opened along a loop, and closed there, is two surfaces") {
    SurfaceMesh mesh(bipyramid_faces(), 5);
    const std::array<std::uint32_t, 3> loop{mesh.edge_between(0, 1), mesh.edge_between(1, 2),
                                            mesh.edge_between(2, 0)};
    mesh.open(loop);
    check_edges(mesh);
    CHECK(count_boundary(mesh) == 6);
    CHECK(mesh.corners(0) == Corners{0, 1, 3});
    CHECK(mesh.corners(3) == Corners{6, 5, 4});
    mesh.add_face({1, 0, 2});
    mesh.add_face({5, 6, 7});
    check_closed(mesh);
    CHECK(count_boundary(mesh) == 0);
    CHECK(euler_number(mesh) == 4);
  }

  TEST_CASE("edges with several faces on one side have no twin") {
    std::vector<Corners> faces = bipyramid_faces();
    faces.push_back({0, 1, 4});
    const SurfaceMesh mesh(faces, 5);
    CHECK(mesh.twin(0) == no_index);
    CHECK(mesh.twin(9) == no_index);
    CHECK(mesh.twin(1) != no_index);
    check_edges(mesh);
  }

  TEST_CASE("columns follow the new numbers") {
    SurfaceMesh mesh(torus_faces(4, 4), 17); // one point has no face
    std::vector<int> of_points(17), of_faces(mesh.face_count()), none;
    for (std::size_t at = 0; at < of_points.size(); ++at)
      of_points[at] = static_cast<int>(at);
    for (std::size_t at = 0; at < of_faces.size(); ++at)
      of_faces[at] = static_cast<int>(at);
    const std::uint32_t edge = mesh.edge_between(5, 6);
    REQUIRE(mesh.can_collapse(edge));
    mesh.collapse(edge);
    Renumbering numbers;
    const std::vector<Corners> faces = mesh.take(numbers);
    keep_values(of_points, numbers.points, no_index);
    keep_values(of_faces, numbers.faces, no_index);
    keep_values(none, numbers.faces, no_index);
    CHECK(none.empty());
    REQUIRE(of_points.size() == 15);
    REQUIRE(of_faces.size() == faces.size());
    CHECK(faces.size() == 30);
    CHECK(numbers.points[6] == no_index);
    CHECK(numbers.points[16] == no_index);
    for (std::size_t at = 0; at < of_points.size(); ++at)
      CHECK(numbers.points[static_cast<std::size_t>(of_points[at])] == at);
    for (const Corners& corners : faces)
      for (const std::uint32_t corner : corners)
        CHECK(corner < 15);
  }
}

} // namespace surface_mesh_test
