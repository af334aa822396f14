#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/join.hpp>
#include <nendo/deform/refinement.hpp>
#include <nendo/deform/subdivision.hpp>
#include <nendo/deform/surface_graph.hpp>
#include <nendo/deform/triangles.hpp>

#include "support/placed_meshes.hpp"
#include "support/prisms.hpp"
#include "support/test_meshes.hpp"

namespace concave_models_test {

using namespace nendo::deform;
using namespace nendo::test;

std::uint32_t longest_face(const Mesh& mesh) {
  std::uint32_t longest = 0;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    longest = std::max(longest, mesh.face_starts[face + 1] - mesh.face_starts[face]);
  return longest;
}

Mesh box(const Eigen::Vector3d& low, const Eigen::Vector3d& high) {
  Mesh mesh = prism(polygon_of({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), 1.0);
  for (auto vertex : mesh.vertices.colwise())
    vertex = low + Eigen::Vector3d(vertex).cwiseProduct(high - low);
  return mesh;
}

TEST_SUITE("concave models") {
  TEST_CASE("a plane cuts both arms of an L, or the whole of it, into closed parts") {
    const Mesh model = l_prism();
    CHECK(volume_of(model) == doctest::Approx(5.0));
    CHECK(area_of(model) == doctest::Approx(22.0));
    for (const Eigen::Vector3d& normal :
         {Eigen::Vector3d(0.02, 1.0, 0.03), Eigen::Vector3d(1.0, 1.0, 0.1),
          Eigen::Vector3d(1.0, -0.3, 0.2), Eigen::Vector3d(0.0, 0.1, 1.0)}) {
      const auto cut = cut_model(model, CutPlane{{0.5, 0.45, 0.5}, normal});
      REQUIRE_MESSAGE(cut, cut.error().message);
      CHECK(cut->parts == 2);
      double volume = 0.0;
      for (const Mesh& part : separate(*cut)) {
        CHECK(check_closed_manifold(part));
        volume += volume_of(part);
      }
      CHECK(volume == doctest::Approx(5.0));
    }
    // Above the notch there are two arms, of which the plane takes the one; faces that it does not
    // touch stay polygons.
    const auto arm = cut_model(model, CutPlane{{2.0, 0.5, 0.5}, {1.0, 0.1, 0.05}});
    REQUIRE(arm);
    CHECK(arm->parts == 2);
    const auto flat = cut_model(model, CutPlane{{0.0, 0.0, 0.5}, {0.0, 0.01, 1.0}});
    REQUIRE(flat);
    CHECK(longest_face(flat->mesh) == 6);
  }

  TEST_CASE("a peg in the arm of an L is joined to it") {
    const Mesh model = l_prism();
    const Mesh peg = box({2.5, 0.25, 0.25}, {3.5, 0.75, 0.75});
    const std::vector<JoinPart> parts{{&model, "L"}, {&peg, "peg"}};
    const auto joined = join(parts, {});
    REQUIRE_MESSAGE(joined, joined.error().message);
    CHECK(check_closed_manifold(joined->mesh));
    CHECK(volume_of(joined->mesh) == doctest::Approx(5.125).epsilon(1e-6));
    CHECK(area_of(joined->mesh) == doctest::Approx(23.0).epsilon(1e-6));
  }

  TEST_CASE("plates with holes by bridges are closed models, which are cut and joined") {
    std::mt19937 random(31);
    for (int holes = 1; holes <= 16; holes += 3) {
      CAPTURE(holes);
      const GridPolygon outline = polygon_with_holes(random, holes);
      const Mesh plate = prism(outline, 1e-3);
      const ManifoldCheck closed = check_closed_manifold(plate);
      CHECK_MESSAGE(closed, describe(closed, plate));
      const double volume = 0.5e-6 * static_cast<double>(grid_area(outline));
      CHECK(volume_of(plate) == doctest::Approx(volume));
      const auto cut = cut_model(plate, CutPlane{{0.5, 2.0, 0.5}, {1.0, 0.3, 0.2}});
      REQUIRE_MESSAGE(cut, cut.error().message);
      double sum = 0.0;
      for (const Mesh& part : separate(*cut)) {
        CHECK(check_closed_manifold(part));
        sum += volume_of(part);
      }
      CHECK(sum == doctest::Approx(volume));
      const Mesh stud = box({3.9, 3.9, 0.2}, {4.9, 4.9, 0.8});
      const std::vector<JoinPart> parts{{&plate, "plate"}, {&stud, "stud"}};
      const auto joined = join(parts, {});
      REQUIRE_MESSAGE(joined, joined.error().message);
      CHECK(volume_of(joined->mesh) == doctest::Approx(volume + 0.6 - 0.006).epsilon(1e-5));
      CHECK(Refiner::check(plate));
    }
  }

  TEST_CASE("corners in line along a side do not keep a model from being cut") {
    std::mt19937 random(5);
    for (int squares = 2; squares < 40; squares += 5) {
      const GridPolygon outline = step_polygon(random, squares);
      if (outline.points.size() < outline.corners.size()) continue;
      const Mesh model = prism(outline, 0.01);
      const auto cut = cut_model(model, CutPlane{{8.5, 8.5, 0.5}, {0.3, 0.2, 1.0}});
      REQUIRE_MESSAGE(cut, cut.error().message);
      double sum = 0.0;
      for (const Mesh& part : separate(*cut))
        sum += volume_of(part);
      CHECK(sum == doctest::Approx(volume_of(model)));
    }
  }

  TEST_CASE("subdividing a concave face does not fold it") {
    const Mesh model = l_prism();
    Mesh finer = model;
    for (int times = 0; times < 3; ++times) {
      finer = subdivide(finer).mesh;
      CHECK(check_closed_manifold(finer));
      CHECK(area_of(finer) == doctest::Approx(22.0));
      CHECK(volume_of(finer) == doctest::Approx(5.0));
    }
    CHECK(finer.vertices.leftCols(model.vertices.cols()) == model.vertices);
  }

  TEST_CASE("ways along a surface lead around a notch, not across it") {
    // A U of two arms that are one apart and ten long, as one face.
    Mesh model = prism(
        polygon_of({{0, 0}, {3, 0}, {3, 10}, {2, 10}, {2, 1}, {1, 1}, {1, 10}, {0, 10}}), 1.0);
    model.face_starts.resize(2); // the top alone
    model.face_corners.resize(8);
    const std::uint32_t first = model.face_corners[3]; // (2, 10)
    const std::uint32_t other = model.face_corners[6]; // (1, 10)
    const SurfaceGraph graph(model);
    const auto distances = graph.distances(SurfacePosition::at_vertex(first), 100.0);
    CHECK(distances[other] == doctest::Approx(19.0).epsilon(0.02));
  }

  TEST_CASE("a shape is cut by the triangles that its model has at rest") {
    // A square of which one corner is drawn in beyond the diagonal.
    const Mesh rest = box({0, 0, 0}, {1, 1, 1});
    Mesh drawn = rest;
    for (const Eigen::Index vertex : {1, 5})
      drawn.vertices.col(vertex).head<2>() << 0.3, 0.6;
    CutOptions options;
    options.rest = &rest.vertices;
    const Mesh kept = in_shape(rest, drawn.vertices);
    CHECK(corners_of_triangles(kept) == corners_of_triangles(rest));
    CHECK(corners_of_triangles(drawn) != corners_of_triangles(rest));
    // By its own places it is a model that can be cut.
    const auto cut = cut_model(drawn, CutPlane{{0.5, 0.5, 0.5}, {0.1, 0.2, 1.0}});
    REQUIRE(cut);
    CHECK(cut->parts == 2);
  }
}

} // namespace concave_models_test
