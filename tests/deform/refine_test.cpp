#include "join/refine.hpp"

#include <algorithm>
#include <random>
#include <utility>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>

#include "join/mesh_surface.hpp"
#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"
#include "support/test_meshes.hpp"

namespace refine_test {

using namespace nendo::deform;

SharedSurfaces shared_of(const Mesh& mesh) {
  const Mesh* const one = &mesh;
  return surfaces_of({&one, 1});
}

struct Lengths {
  double least = 1e300, most = 0.0;
};

Lengths lengths_of(const LiveSurface& surface) {
  Lengths lengths;
  for (std::uint32_t face = 0; face < surface.face_count(); ++face) {
    if (!surface.has_face(face)) continue;
    for (std::uint32_t edge = 3 * face; edge < 3 * face + 3; ++edge) {
      lengths.least = std::min(lengths.least, surface.edge_length(edge));
      lengths.most = std::max(lengths.most, surface.edge_length(edge));
    }
  }
  return lengths;
}

RefineZone everywhere(const LiveSurface& surface, char hold) {
  return {std::vector<float>(surface.point_count(), 1.0f),
          std::vector<char>(surface.point_count(), hold)};
}

TEST_SUITE("refine") {
  TEST_CASE("edges come within limits, and a flat-sided body keeps its shape") {
    Mesh box = nendo::test::cube_of_cells(1);
    const SharedSurfaces shared = shared_of(box);
    LiveSurface surface(shared.surfaces[0]);
    RefineZone zone = everywhere(surface, 2);
    const RefineLimits limits{.longest = 0.1, .shortest = 0.04, .budget = 100000};
    for (int round = 0; round < 20; ++round) {
      const RefineCounts done = refine(surface, zone, limits);
      if (done.splits + done.collapses + done.flips == 0) break;
    }
    const Lengths lengths = lengths_of(surface);
    CHECK(lengths.most <= 0.1);
    CHECK(lengths.least >= 0.02);
    const Mesh fine = mesh_of(surface.take(), shared.look);
    CHECK(check_closed_manifold(fine));
    CHECK(volume_of(fine) == doctest::Approx(1.0).epsilon(1e-12));
    CHECK(fine.vertices.leftCols(8) == box.vertices);
  }

  TEST_CASE("a fine ball becomes coarser, stays closed, and nearly keeps its volume") {
    const Mesh ball = nendo::test::sphere(60, 90, 1.0);
    const SharedSurfaces shared = shared_of(ball);
    LiveSurface surface(shared.surfaces[0]);
    RefineZone zone = everywhere(surface, 0);
    const RefineLimits limits{.longest = 0.2, .shortest = 0.09, .budget = 100000};
    for (int round = 0; round < 20; ++round)
      refine(surface, zone, limits);
    const Mesh coarse = mesh_of(surface.take(), shared.look);
    CHECK(coarse.face_count() < 4000);
    CHECK(check_closed_manifold(coarse));
    CHECK(volume_of(coarse) == doctest::Approx(volume_of(ball)).epsilon(0.02));
  }

  TEST_CASE("the budget bounds what is done, and says what is left") {
    LiveSurface surface(shared_of(nendo::test::cube_of_cells(1)).surfaces[0]);
    RefineZone zone = everywhere(surface, 2);
    const RefineCounts done = refine(surface, zone, {.longest = 0.5, .shortest = 0.1, .budget = 5});
    CHECK(done.splits == 5);
    CHECK(done.left == 13); // of the cube's 12 edges and 6 diagonals
    LiveSurface bounded(shared_of(nendo::test::cube_of_cells(1)).surfaces[0]);
    zone = everywhere(bounded, 2);
    refine(bounded, zone, {.longest = 0.5, .shortest = 0.1, .budget = 50, .max_points = 10});
    CHECK(bounded.point_count() == 10);
  }

  TEST_CASE("what is outside of the zone keeps its bits") {
    const Mesh ball = nendo::test::sphere(30, 40, 1.0);
    const SharedSurfaces shared = shared_of(ball);
    LiveSurface surface(shared.surfaces[0]);
    RefineZone zone = everywhere(surface, 0);
    std::vector<char> outside(surface.point_count(), 0);
    for (std::uint32_t point = 0; point < surface.point_count(); ++point)
      if (surface.point(point)[2] < 0.5) {
        zone.coarseness[point] = 0.0f;
        zone.hold[point] = 2;
        outside[point] = 1;
      }
    for (int round = 0; round < 8; ++round)
      refine(surface, zone, {.longest = 0.04, .shortest = 0.016, .budget = 100000});
    std::vector<std::uint32_t> numbers;
    const TriangleSurface fine = surface.take(&numbers);
    CHECK(fine.points.size() > shared.surfaces[0].points.size());
    for (std::uint32_t point = 0; point < outside.size(); ++point)
      if (outside[point]) CHECK(fine.points[numbers[point]] == shared.surfaces[0].points[point]);
  }

  TEST_CASE("borders between materials stay where they are") {
    Mesh ball = nendo::test::sphere(31, 40, 1.0);
    ball.look.materials = {{"top", {}}, {"bottom", {}}};
    for (std::size_t face = 0; face < ball.face_count(); ++face) {
      double height = 0.0;
      for (std::uint32_t at = ball.face_starts[face]; at < ball.face_starts[face + 1]; ++at)
        height += ball.vertices(2, ball.face_corners[at]);
      ball.look.face_materials.push_back(height > 0.0 ? 0 : 1);
    }
    const SharedSurfaces shared = shared_of(ball);
    LiveSurface surface(shared.surfaces[0]);
    RefineZone zone = everywhere(surface, 0);
    for (int round = 0; round < 10; ++round)
      refine(surface, zone, {.longest = 0.3, .shortest = 0.14, .budget = 100000});
    const Mesh coarse = mesh_of(surface.take(), shared.look);
    CHECK(check_closed_manifold(coarse));
    CHECK(coarse.face_count() < ball.face_count());
    for (std::size_t face = 0; face < coarse.face_count(); ++face)
      for (std::size_t at = 3 * face; at < 3 * face + 3; ++at) {
        const double height = coarse.vertices(2, coarse.face_corners[at]);
        if (coarse.look.face_materials[face] == 0)
          CHECK(height > -1e-9);
        else
          CHECK(height < 1e-9);
      }
  }

  TEST_CASE("single operations keep the surface closed") {
    std::mt19937 random(3);
    const SharedSurfaces shared = shared_of(nendo::test::torus(24, 12));
    LiveSurface surface(shared.surfaces[0]);
    for (int step = 0; step < 3000; ++step) {
      const auto edge = static_cast<std::uint32_t>(random() % (3 * surface.face_count()));
      if (!surface.has_face(edge / 3)) continue;
      switch (random() % 4) {
      case 0:
        if (surface.point_count() < 1500) surface.split(edge);
        break;
      case 1:
        surface.flip(edge);
        break;
      default:
        surface.collapse(edge, {.longest = 10.0});
      }
      if (step % 100 == 0)
        for (std::uint32_t at = 0; at < 3 * surface.face_count(); ++at)
          if (surface.has_face(at / 3)) {
            REQUIRE(surface.twin(surface.twin(at)) == at);
            REQUIRE(surface.from(surface.twin(at)) == surface.to(at));
          }
    }
    const Mesh mesh = mesh_of(surface.take(), shared.look);
    REQUIRE(check_closed_manifold(mesh));
    const auto faces = static_cast<long>(mesh.face_count());
    CHECK(mesh.vertices.cols() - faces / 2 == 0); // a torus' Euler characteristic
  }
}

} // namespace refine_test
