#include "join/self_intersections.hpp"

#include <random>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "geometry/triangle_meeting.hpp"
#include "join/mesh_surface.hpp"
#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"
#include "support/self_intersections.hpp"
#include "support/test_meshes.hpp"

namespace self_intersections_test {

using namespace nendo::deform;
using nendo::test::count_self_intersections;

/// Points and triangles without names, to be tried in all orders.
struct Pair {
  std::vector<SpacePoint> points;
  Corners one, other;
};

bool meet_in_all_orders(const Pair& pair) {
  const auto turned = [](const Corners& corners, std::size_t by, bool mirrored) {
    Corners result{corners[by], corners[(by + 1) % 3], corners[(by + 2) % 3]};
    if (mirrored) std::swap(result[0], result[1]);
    return result;
  };
  const bool first = triangles_meet(pair.points, pair.one, pair.other);
  for (std::size_t order = 0; order < 36; ++order) {
    const Corners one = turned(pair.one, order % 3, order % 2 == 1);
    const Corners other = turned(pair.other, order / 12, order / 6 % 2 == 1);
    CHECK(triangles_meet(pair.points, one, other) == first);
    CHECK(triangles_meet(pair.points, other, one) == first);
  }
  return first;
}

TEST_SUITE("self-intersections") {
  TEST_CASE("two triangles that share nothing meet if they touch") {
    const std::vector<SpacePoint> base{{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    const auto with = [&](SpacePoint a, SpacePoint b, SpacePoint c) {
      Pair pair{base, {0, 1, 2}, {3, 4, 5}};
      pair.points.insert(pair.points.end(), {a, b, c});
      return meet_in_all_orders(pair);
    };
    CHECK(with({1, 1, -1}, {1, 1, 1}, {2, 1, 1}));        // goes through
    CHECK_FALSE(with({1, 1, 0.5}, {1, 1, 1}, {2, 1, 1})); // is above
    CHECK(with({1, 1, 0}, {1, 1, 1}, {2, 1, 1}));         // a corner on the inside
    CHECK(with({2, 0, 0}, {2, 0, 1}, {2, -1, 1}));        // a corner on an edge
    CHECK(with({4, 0, 0}, {5, 0, 1}, {5, 1, 1}));         // corner on corner
    CHECK(with({2, -1, -1}, {2, 1, 1}, {9, 0, 0}));       // edge through edge
    CHECK(with({-1, -1, 0}, {9, -1, 0}, {-1, 9, 0}));     // in the plane, around
    CHECK(with({0.5, 0.5, 0}, {1, 0.5, 0}, {0.5, 1, 0})); // in the plane, within
    CHECK(with({1, -1, 0}, {2, -1, 0}, {1, 5, 0}));       // in the plane, across
    CHECK_FALSE(with({5, 5, 0}, {6, 5, 0}, {5, 6, 0}));   // in the plane, beside
    CHECK_FALSE(with({3, 3, -1}, {3, 3, 1}, {4, 4, 0}));  // through the plane, beside
    CHECK_FALSE(with({2, 2 + 1e-15, -1}, {2, 2 + 1e-15, 1}, {4, 4, 0})); // by five roundings
    CHECK(with({2, 2, -1}, {2, 2, 1}, {4, 4, 0}));
  }

  TEST_CASE("two triangles that share a vertex or an edge meet only beyond it") {
    const std::vector<SpacePoint> points{{0, 0, 0},  {4, 0, 0},   {0, 4, 0}, {1, 1, 2}, {1, 1, -2},
                                         {-4, 0, 1}, {-1, -4, 0}, {2, 2, 0}, {1, 2, 0}};
    const auto meet = [&](Corners one, Corners other) {
      return meet_in_all_orders({points, one, other});
    };
    CHECK_FALSE(meet({0, 1, 2}, {0, 5, 6})); // away from each other
    CHECK(meet({0, 1, 2}, {0, 3, 4}));       // through the face
    CHECK(meet({0, 1, 2}, {0, 7, 3}));       // along the face
    CHECK_FALSE(meet({0, 1, 2}, {0, 1, 3})); // a fold
    CHECK_FALSE(meet({0, 1, 2}, {0, 1, 6})); // flat, to both sides of the edge
    CHECK(meet({0, 1, 2}, {0, 1, 8}));       // flat, to the same side
    CHECK(meet({0, 1, 2}, {1, 0, 2}));       // the same one, turned
  }

  TEST_CASE("a triangle without area is found") {
    const std::vector<SpacePoint> points{{0.1, 0.2, 0.3}, {0.2, 0.4, 0.6}, {0.4, 0.8, 1.2}};
    const std::vector<Corners> triangles{{0, 1, 2}};
    CHECK(self_intersections(points, triangles) == std::vector<TrianglePair>{{0, 0}});
  }

  TEST_CASE("models have none, and after a dent as many as a plain count finds") {
    std::mt19937 random(7);
    for (const char* name : {"moai.obj", "spot.obj"}) {
      auto model = read_mesh(std::filesystem::path(NENDO_MODELS) / name);
      REQUIRE(model);
      const auto pairs_of = [&] {
        const Mesh* const mesh = &*model;
        const TriangleSurface surface = surfaces_of({&mesh, 1}).surfaces[0];
        return self_intersections(surface.points, surface.faces);
      };
      CHECK(pairs_of().empty());
      const double radius = 0.2 * diagonal_of(model->vertices);
      for (int dent = 0; dent < 3; ++dent) {
        const Eigen::Vector3d middle =
            model->vertices.col(static_cast<Eigen::Index>(random() % 5000));
        for (Eigen::Index at = 0; at < model->vertices.cols(); ++at) {
          const double part = (model->vertices.col(at) - middle).norm() / radius;
          if (part < 1.0) model->vertices.col(at).x() -= 2.0 * radius * (1.0 - part);
        }
      }
      const auto pairs = pairs_of();
      CHECK(pairs.size() > 10);
      CHECK(pairs.size() == count_self_intersections(*model));
    }
  }

  TEST_CASE("pairs of changed triangles are those of all that have one of them") {
    const Mesh mesh = nendo::test::moved(nendo::test::sphere(20, 30, 1.0), {0.3, 0.0, 0.0});
    const Mesh two = nendo::test::sphere(20, 30, 1.0);
    const Mesh* const both[] = {&mesh, &two};
    const auto surfaces = surfaces_of(both).surfaces;
    std::vector<SpacePoint> points = surfaces[0].points;
    std::vector<Corners> faces = surfaces[0].faces;
    const auto first = static_cast<std::uint32_t>(points.size());
    points.insert(points.end(), surfaces[1].points.begin(), surfaces[1].points.end());
    for (const Corners& face : surfaces[1].faces)
      faces.push_back({face[0] + first, face[1] + first, face[2] + first});
    const auto all = self_intersections(points, faces);
    REQUIRE(all.size() > 50);
    std::vector<std::uint32_t> changed;
    for (std::uint32_t face = 0; face < faces.size(); face += 3)
      changed.push_back(face);
    std::vector<TrianglePair> expected;
    for (const auto& pair : all)
      if (pair.first % 3 == 0 || pair.second % 3 == 0) expected.push_back(pair);
    CHECK(self_intersections_of(points, faces, changed) == expected);
    CHECK(self_intersections(points, faces, 5).size() == 5);
  }
}

} // namespace self_intersections_test
