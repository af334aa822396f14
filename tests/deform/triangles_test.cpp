#include <nendo/deform/triangles.hpp>

#include <array>
#include <chrono>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "geometry/triangle_meeting.hpp"
#include "support/random_polygons.hpp"
#include "support/test_meshes.hpp"

namespace triangles_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using nendo::test::GridPolygon;
using Way = std::pair<std::uint32_t, std::uint32_t>;

Mesh mesh_of(const GridPolygon& polygon) {
  Mesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(polygon.points.size()));
  for (std::size_t at = 0; at < polygon.points.size(); ++at)
    mesh.vertices.col(static_cast<Eigen::Index>(at)) << static_cast<double>(polygon.points[at][0]),
        static_cast<double>(polygon.points[at][1]), 0.0;
  mesh.face_corners = polygon.corners;
  mesh.face_starts.push_back(static_cast<std::uint32_t>(polygon.corners.size()));
  return mesh;
}

std::vector<Triangle> corner_triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for_each_face_triangle(
      mesh, [&](std::size_t, const Triangle& corners) { triangles.push_back(corners); });
  return triangles;
}

std::vector<Triangle> vertex_triangles(const Mesh& mesh) {
  std::vector<Triangle> triangles;
  for_each_triangle(mesh, [&](const Triangle& vertices) { triangles.push_back(vertices); });
  return triangles;
}

/// Of the corners from the first one on.
std::vector<Triangle> fan_of(std::uint32_t corners) {
  std::vector<Triangle> fan;
  for (std::uint32_t at = 2; at < corners; ++at)
    fan.push_back({0, at - 1, at});
  return fan;
}

Vector3d area_of(const Mesh& mesh, const Triangle& vertices) {
  const Vector3d a = mesh.vertices.col(vertices[0]), b = mesh.vertices.col(vertices[1]);
  return (b - a).cross(mesh.vertices.col(vertices[2]) - a) / 2.0;
}

/// Newell's, of the first face.
Vector3d area_of_face(const Mesh& mesh) {
  Vector3d sum = Vector3d::Zero();
  for (std::uint32_t at = 2; at < mesh.face_starts[1]; ++at)
    sum += area_of(mesh, {mesh.face_corners[0], mesh.face_corners[at - 1], mesh.face_corners[at]});
  return sum;
}

/// Each edge of the face is run along once, and each other edge once in both directions. With
/// vertices instead of corners, ways there and back along a bridge cancel out.
bool has_edges_of_face(const std::vector<Triangle>& triangles,
                       const std::vector<std::uint32_t>& corners) {
  std::map<Way, int> ways;
  for (const Triangle& triangle : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      ++ways[{triangle[k], triangle[(k + 1) % 3]}];
  for (std::size_t at = 0; at < corners.size(); ++at)
    --ways[{corners[at], corners[(at + 1) % corners.size()]}];
  for (const auto& [way, count] : ways)
    if (count != 0 && (way.first != way.second) && ways[{way.second, way.first}] != count)
      return false;
  return true;
}

/// No edge has more than one triangle on a side.
bool is_two_manifold(const std::vector<Triangle>& triangles) {
  std::map<Way, int> ways;
  for (const Triangle& triangle : triangles)
    for (std::size_t k = 0; k < 3; ++k)
      if (++ways[{triangle[k], triangle[(k + 1) % 3]}] > 1) return false;
  return true;
}

/// Exactly, of whole numbers.
void check_exactly(const GridPolygon& polygon, bool all_have_area = true) {
  const Mesh mesh = mesh_of(polygon);
  const auto triangles = vertex_triangles(mesh);
  if (all_have_area) CHECK(triangles.size() == polygon.corners.size() - 2);
  CHECK(triangles.size() + 2 <= polygon.corners.size());
  CHECK(has_edges_of_face(triangles, polygon.corners));
  CHECK(is_two_manifold(triangles));
  std::int64_t area = 0;
  int without_area = 0;
  for (const Triangle& triangle : triangles) {
    const std::int64_t own = nendo::test::grid_turn(
        polygon.points[triangle[0]], polygon.points[triangle[1]], polygon.points[triangle[2]]);
    CHECK(own >= 0);
    if (own == 0) ++without_area;
    area += own;
  }
  CHECK(area == nendo::test::grid_area(polygon));
  if (all_have_area) CHECK(without_area == 0);
  std::vector<SpacePoint> places;
  for (const auto& point : polygon.points)
    places.push_back({static_cast<double>(point[0]), static_cast<double>(point[1]), 0.0});
  int overlaps = 0;
  for (std::size_t one = 0; one < triangles.size() && all_have_area && triangles.size() < 200;
       ++one)
    for (std::size_t other = one + 1; other < triangles.size(); ++other)
      if (triangles_meet(places, triangles[one], triangles[other])) ++overlaps;
  CHECK(overlaps == 0);
}

/// Turned anywhere, far away, of floats, and not quite flat: its triangles are right in the plane
/// that it has there.
void check_turned(const GridPolygon& polygon, std::mt19937& random, double warp) {
  std::normal_distribution<double> normal;
  Mesh mesh = mesh_of(polygon);
  for (Eigen::Index at = 0; at < mesh.vertices.cols(); ++at)
    mesh.vertices(2, at) = warp * normal(random);
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
          .normalized();
  const Vector3d away = 1e5 * Vector3d(normal(random), normal(random), normal(random));
  for (auto vertex : mesh.vertices.colwise())
    vertex = (turn * Vector3d(vertex) + away).cast<float>().cast<double>();
  const auto triangles = corner_triangles(mesh);
  CHECK(triangles.size() == polygon.corners.size() - 2);
  std::vector<std::uint32_t> all(polygon.corners.size());
  std::iota(all.begin(), all.end(), 0U);
  CHECK(has_edges_of_face(triangles, all));
  CHECK(is_two_manifold(triangles));
  const Vector3d whole = area_of_face(mesh);
  const Vector3d up = whole.normalized();
  double area = 0.0, least = 0.0;
  for (const Triangle& triangle : triangles) {
    const double own =
        up.dot(area_of(mesh, {mesh.face_corners[triangle[0]], mesh.face_corners[triangle[1]],
                              mesh.face_corners[triangle[2]]}));
    area += own;
    least = std::min(least, own);
  }
  CHECK(area == doctest::Approx(whole.norm()).epsilon(1e-9));
  CHECK(least >= -1e-9 * whole.norm());
}

TEST_SUITE("triangles") {
  TEST_CASE("a convex face is a fan about its first corner, wherever it lies") {
    std::mt19937 random(71);
    std::normal_distribution<double> normal;
    for (std::uint32_t corners = 3; corners <= 60; ++corners) {
      CAPTURE(corners);
      Mesh mesh;
      mesh.vertices.resize(3, corners);
      const Eigen::Quaterniond turn =
          Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
              .normalized();
      for (std::uint32_t at = 0; at < corners; ++at) {
        const double angle = 2.0 * std::numbers::pi * at / corners;
        mesh.vertices.col(at) =
            turn * Vector3d(std::cos(angle), std::sin(angle), 0.0) + Vector3d(3.0, -40.0, 500.0);
        mesh.face_corners.push_back(at);
      }
      mesh.face_starts.push_back(corners);
      CHECK(corner_triangles(mesh) == fan_of(corners));
      FaceTriangles triangles(mesh);
      CHECK(triangles.is_convex(0));
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

  TEST_CASE("a fan is kept where it is right, and a concave quad is cut at its notch") {
    // An arrow's head, with the notch at each of its corners in turn.
    const std::vector<nendo::test::GridPoint> arrow{{0, 0}, {200, 100}, {0, 200}, {70, 100}};
    for (std::uint32_t first = 0; first < 4; ++first) {
      auto points = arrow;
      std::rotate(points.begin(), points.begin() + first, points.end());
      const GridPolygon polygon = nendo::test::polygon_of(points);
      check_exactly(polygon);
      const Mesh mesh = mesh_of(polygon);
      const bool notch_first = first % 2 == 1; // or opposite, so that the fan is right
      CHECK((corner_triangles(mesh) == fan_of(4)) == notch_first);
      FaceTriangles triangles(mesh);
      CHECK_FALSE(triangles.is_convex(0));
    }
  }

  TEST_CASE("polygons of every kind are covered once by triangles that face their way") {
    std::mt19937 random(4711);
    for (int round = 0; round < 60; ++round) {
      CAPTURE(round);
      const std::vector<GridPolygon> polygons{
          nendo::test::star_polygon(random, 4 + round),
          nendo::test::comb_polygon(random, 1 + round % 20),
          nendo::test::tangled_polygon(random, 4 + round % 16),
          nendo::test::spiral_polygon(20 + 4 * round, 0.5 + 0.05 * round),
      };
      for (std::size_t kind = 0; kind < polygons.size(); ++kind) {
        CAPTURE(kind);
        check_exactly(polygons[kind]);
        check_turned(polygons[kind], random, 0.0);
        if (kind != 2) check_turned(polygons[kind], random, 0.5);
      }
    }
  }

  TEST_CASE("many corners in line give no triangle without area") {
    std::mt19937 random(99);
    for (int round = 0; round < 60; ++round) {
      CAPTURE(round);
      const GridPolygon polygon = nendo::test::step_polygon(random, 1 + round);
      const bool touches_itself = polygon.points.size() < polygon.corners.size();
      check_exactly(polygon, !touches_itself);
    }
    // A square whose first corner is in the middle of a side.
    check_exactly(nendo::test::polygon_of({{50, 0}, {100, 0}, {100, 100}, {0, 100}, {0, 0}}));
    check_exactly(nendo::test::polygon_of({{0, 0}, {50, 0}, {100, 0}, {100, 100}, {0, 100}}));
  }

  TEST_CASE("holes that bridges join to the rim stay open") {
    std::mt19937 random(12);
    for (int round = 0; round < 48; ++round) {
      CAPTURE(round);
      const GridPolygon polygon = nendo::test::polygon_with_holes(random, 1 + round / 3);
      CHECK(polygon.points.size() < polygon.corners.size());
      check_exactly(polygon);
      check_turned(polygon, random, 0.0);
      // Writers of files may give the bridge vertices of its own, in the same places.
      GridPolygon apart;
      for (const std::uint32_t corner : polygon.corners) {
        apart.corners.push_back(static_cast<std::uint32_t>(apart.points.size()));
        apart.points.push_back(polygon.points[corner]);
      }
      const Mesh mesh = mesh_of(apart);
      double area = 0.0;
      for (const Triangle& triangle : vertex_triangles(mesh)) {
        const double own = area_of(mesh, triangle).z();
        CHECK(own > 0.0);
        area += own;
      }
      CHECK(area == 0.5 * static_cast<double>(nendo::test::grid_area(polygon)));
    }
  }

  TEST_CASE("parts that touch in a corner, spikes and repeated corners lose no area") {
    using nendo::test::GridPoint;
    const std::vector<GridPolygon> polygons{
        // Two triangles that meet in vertex 0.
        {{{0, 0}, {100, -50}, {100, 50}, {-100, 50}, {-100, -50}}, {0, 1, 2, 0, 3, 4}},
        // A square with a spike outwards, and one with a slit inwards.
        {{{0, 0}, {100, 0}, {100, 100}, {0, 100}, {200, 200}}, {0, 1, 2, 4, 2, 3}},
        {{{0, 0}, {100, 0}, {100, 100}, {0, 100}, {50, 50}}, {0, 1, 2, 4, 2, 3}},
        // A corner twice in a row, and the first corner again at the end.
        {{{0, 0}, {100, 0}, {100, 100}, {0, 100}}, {0, 1, 1, 2, 3}},
        {{{0, 0}, {100, 0}, {100, 100}, {0, 100}}, {0, 1, 2, 3, 0}},
        // Another vertex in the same place.
        {{{0, 0}, {100, 0}, {100, 0}, {100, 100}, {0, 100}}, {0, 1, 2, 3, 4}},
        // A corner that touches the middle of a side from inside.
        {{{0, 0}, {100, 0}, {100, 100}, {60, 100}, {50, 0}, {40, 100}, {0, 100}},
         {0, 1, 2, 3, 4, 5, 6}},
    };
    for (std::size_t number = 0; number < polygons.size(); ++number) {
      CAPTURE(number);
      const GridPolygon& polygon = polygons[number];
      for (std::size_t first = 0; first < polygon.corners.size(); ++first) {
        CAPTURE(first);
        GridPolygon turned = polygon;
        std::rotate(turned.corners.begin(),
                    turned.corners.begin() + static_cast<std::ptrdiff_t>(first),
                    turned.corners.end());
        check_exactly(turned, false);
      }
    }
    // The slit's end becomes a corner of triangles with area.
    CHECK(vertex_triangles(mesh_of(polygons[2])).size() == 4);
  }

  TEST_CASE("what is no polygon gives triangles of its corners nevertheless") {
    std::mt19937 random(3);
    std::uniform_int_distribution<std::int64_t> place(0, 6);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (int round = 0; round < 3000; ++round) {
      std::vector<nendo::test::GridPoint> points(4 + static_cast<std::size_t>(round % 90));
      for (auto& point : points)
        point = {place(random), place(random)};
      Mesh mesh = mesh_of(nendo::test::polygon_of(points));
      if (round % 10 == 3) mesh.vertices *= 1e-40;
      if (round % 10 == 4) mesh.vertices *= 1e200;
      if (round % 10 == 5) mesh.vertices(0, 1) = infinity;
      if (round % 10 == 6) mesh.vertices.row(1) = mesh.vertices.row(0);
      const auto triangles = corner_triangles(mesh);
      CHECK(triangles.size() == points.size() - 2);
      CHECK(has_edges_of_face(triangles, mesh.face_corners));
      CHECK(is_two_manifold(triangles));
    }
  }

  TEST_CASE("a face of very many corners takes its time once") {
    std::mt19937 random(8);
    const auto before = std::chrono::steady_clock::now();
    check_exactly(nendo::test::spiral_polygon(20'000, 40.0));
    check_exactly(nendo::test::comb_polygon(random, 5'000));
    CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(60));
  }

  TEST_CASE("texture coordinates, materials and names follow the triangles of split faces") {
    Mesh mesh = mesh_of(nendo::test::polygon_of({{0, 0}, {200, 100}, {0, 200}, {70, 100}}));
    nendo::test::add_face(mesh, {0, 1, 2});
    mesh.texcoords.resize(2, 7);
    mesh.corner_texcoords = {0, 1, 2, 3, 4, 5, 6};
    mesh.look.face_materials = {5, 6};
    mesh.look.groups.of_face = {1, 2};
    const Mesh split = with_split_faces(mesh, mesh.vertices, {true, false});
    REQUIRE(split.face_count() == 3);
    CHECK(split.look.face_materials == std::vector<std::uint32_t>{5, 5, 6});
    CHECK(split.look.groups.of_face == std::vector<std::uint32_t>{1, 1, 2});
    CHECK(split.look.objects.of_face.empty());
    for (std::size_t at = 0; at < 6; ++at)
      CHECK(split.corner_texcoords[at] == split.face_corners[at]);
    CHECK(split.corner_texcoords[6] == 4);
  }

  TEST_CASE("a shape keeps the triangles of its rest when it becomes a model") {
    Mesh rest = mesh_of(nendo::test::polygon_of({{0, 0}, {100, 0}, {100, 100}, {0, 100}}));
    nendo::test::add_face(rest, {3, 2, 1, 0});
    Mesh shaped = rest;
    CHECK(with_triangles_of(shaped, rest.vertices).face_count() == 2);
    shaped.vertices.col(1) << 20, 60, 0; // now the fan about the first corner folds
    CHECK(vertex_triangles(shaped) != vertex_triangles(rest));
    const Mesh kept = with_triangles_of(shaped, rest.vertices);
    CHECK(vertex_triangles(kept) == vertex_triangles(rest));
    CHECK(kept.face_count() == 3); // of the other face, the fan is still right
  }
}

} // namespace triangles_test
