#include <nendo/deform/refinement.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <utility>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "join/mesh_surface.hpp"
#include "join/triangle_surface.hpp"
#include "reference/icosphere.hpp"
#include "support/cut_laws.hpp"
#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"
#include "support/test_meshes.hpp"
#include "support/triangle_angles.hpp"

namespace refinement_test {

using namespace nendo;
using namespace nendo::deform;
using Eigen::Vector3d;

Mesh ball() {
  return reference::icosphere(4, 1.0);
}

BlockShape packed(const BlockLayout& layout, const Points& places) {
  Eigen::Matrix3Xf numbers(3, places.cols());
  for (Eigen::Index at = 0; at < places.cols(); ++at)
    numbers.col(at) = ((places.col(at) - layout.origin()) / layout.unit()).cast<float>();
  return shape_in_blocks(numbers, layout);
}

/// What the vertices of a refinement are, in model units.
Points places_of(const Refinement& made) {
  const BlockLayout layout(made.mesh.vertices);
  Points places;
  layout.unpack(shape_in_blocks(made.shape, layout), places);
  return places;
}

/// Pulls what is near +x outwards, four times as far.
Points pulled(Points places, double way = 3.0) {
  for (auto place : places.colwise()) {
    const double near = std::max(0.0, 1.0 - (place - Vector3d(1, 0, 0)).norm() / 0.6);
    place[0] += way * near * near * (3.0 - 2.0 * near);
  }
  return places;
}

struct Shaped {
  Mesh mesh;
  BlockLayout layout;
  BlockShape shape;
  Shaped(Mesh of, const Points& places)
      : mesh(std::move(of)), layout(mesh.vertices), shape(packed(layout, places)) {}

  Refinement refine(const RefinementLimits& limits = {}) const {
    const auto refiner = Refiner::make(mesh);
    REQUIRE(refiner);
    return refiner->refine(shape, layout, limits);
  }
  std::size_t unfit(const RefinementLimits& limits = {}) const {
    const auto refiner = Refiner::make(mesh);
    REQUIRE(refiner);
    return refiner->count_unfit(shape, layout, limits);
  }
};

Mesh at_places(Mesh mesh, const Points& places) {
  mesh.vertices = places;
  return mesh;
}

/// Whether any triangles of the mesh meet, if its vertices are there.
bool meets_itself(const Mesh& mesh, const Points& places) {
  return nendo::test::count_meetings(at_places(mesh, places)) > 0;
}

void check_repeats(const Shaped& before, const Refinement& made) {
  const auto again = refined(before.mesh, made.operations);
  REQUIRE(again);
  CHECK(again->vertices == made.mesh.vertices);
  CHECK(again->face_corners == made.mesh.face_corners);
  CHECK(again->texcoords == made.mesh.texcoords);
  CHECK(again->corner_texcoords == made.mesh.corner_texcoords);
  CHECK(again->look.vertex_colours == made.mesh.look.vertex_colours);
  CHECK(again->look.face_materials == made.mesh.look.face_materials);
  CHECK(again->detail == made.mesh.detail);
}

TEST_SUITE("refinement") {
  TEST_CASE("what is stretched gets vertices, and the untouched rest keeps its bits") {
    const Shaped before(ball(), pulled(ball().vertices));
    const std::size_t unfit = before.unfit();
    CHECK(unfit > 100);
    const Refinement made = before.refine();
    CHECK(check_closed_manifold(made.mesh));
    CHECK(nendo::test::euler_number(made.mesh) == 2);
    CHECK(made.mesh.vertices.cols() > before.mesh.vertices.cols() + 100);
    const Points places = places_of(made);
    CHECK_FALSE(meets_itself(made.mesh, places));
    const auto angles = nendo::test::min_angles(at_places(made.mesh, places));
    CHECK(angles[angles.size() / 20] > 20.0);
    const Shaped after(made.mesh, places);
    CHECK(after.unfit() < unfit / 10);
    // The far side: the same places, in the same order.
    Eigen::Index at = 0;
    for (Eigen::Index vertex = 0; vertex < before.mesh.vertices.cols(); ++vertex) {
      const Vector3d rest = before.mesh.vertices.col(vertex);
      if (rest[0] > 0.3) continue;
      while (at < made.mesh.vertices.cols() && made.mesh.vertices.col(at) != rest)
        ++at;
      REQUIRE(at < made.mesh.vertices.cols());
      CHECK(places.col(at) == rest);
    }
    check_repeats(before, made);
  }

  TEST_CASE("a shape that no hand has touched stays as it is, however uneven its edges are") {
    for (const Mesh& mesh : {ball(), nendo::test::cube_of_cells(4), nendo::test::torus(12, 30)}) {
      const Shaped before(mesh, mesh.vertices);
      CHECK(before.unfit() == 0);
      CHECK(before.refine().operations.empty());
      Points moved = mesh.vertices;
      moved.row(1).array() += 0.25; // a whole number of floats' steps
      CHECK(Shaped(mesh, moved).refine().operations.empty());
    }
  }

  TEST_CASE("what is pressed flat loses vertices, and what is pulled again gets some") {
    const Mesh mesh = ball();
    Points flat = mesh.vertices;
    flat.row(0) *= 0.25;
    const Refinement pressed = Shaped(mesh, flat).refine();
    CHECK(pressed.mesh.vertices.cols() < mesh.vertices.cols() - 100);
    const Points places = places_of(pressed);
    CHECK_FALSE(meets_itself(pressed.mesh, places));
    Points round = places;
    round.row(0) *= 4.0;
    const Shaped again(pressed.mesh, round);
    const Refinement pulled_back = again.refine();
    CHECK(pulled_back.mesh.vertices.cols() > pressed.mesh.vertices.cols());
    CHECK(pulled_back.mesh.detail.size() ==
          static_cast<std::size_t>(pulled_back.mesh.vertices.cols()));
    check_repeats(again, pulled_back);
  }

  TEST_CASE("a model's fine parts stay finer than its coarse ones") {
    const Mesh mesh = nendo::test::normalised(*read_mesh(NENDO_MODELS "/moai.obj"));
    Points longer = mesh.vertices;
    longer.row(1) *= 1.6; // all of it is touched
    const Refinement made = Shaped(mesh, longer).refine();
    CHECK(made.mesh.vertices.cols() < 2 * mesh.vertices.cols());
    std::vector<float> edges;
    for (const VertexDetail& of : made.mesh.detail)
      edges.push_back(of.edge);
    std::sort(edges.begin(), edges.end());
    const float fine = edges[edges.size() / 4];
    const float coarse = edges[3 * edges.size() / 4];
    REQUIRE(fine < 0.8f * coarse);
    const Points places = places_of(made);
    double sums[2] = {}; // of edges between fine vertices, and between coarse ones
    int counts[2] = {};
    for (std::size_t at = 0; at < made.mesh.face_corners.size(); ++at) {
      const std::uint32_t from = made.mesh.face_corners[at];
      const std::uint32_t to = made.mesh.face_corners[at % 3 == 2 ? at - 2 : at + 1];
      const auto [less, more] = std::minmax(made.mesh.detail[from].edge, made.mesh.detail[to].edge);
      if (more > fine && less < coarse) continue;
      const int which = more <= fine ? 0 : 1;
      sums[which] += (places.col(from) - places.col(to)).norm();
      ++counts[which];
    }
    CHECK(sums[0] / counts[0] < 0.8 * sums[1] / counts[1]);
  }

  TEST_CASE("colours, texture and materials follow, and their borders stay") {
    Mesh mesh = nendo::test::cube_of_cells(8);
    const auto half = static_cast<std::uint32_t>(mesh.face_count() / 2);
    mesh.look.materials.resize(2);
    mesh.look.materials[0].name = "one";
    mesh.look.materials[1].name = "other";
    for (std::uint32_t face = 0; face < mesh.face_count(); ++face)
      mesh.look.face_materials.push_back(face < half ? 0 : 1);
    mesh.look.vertex_colours = mesh.vertices.cast<float>().colwise().homogeneous();
    mesh.texcoords = mesh.vertices.topRows(2);
    mesh.corner_texcoords = mesh.face_corners;
    Points places = mesh.vertices;
    for (auto place : places.colwise())
      place[0] *= 1.0 + 2.0 * place[0] * place[0];
    const Shaped before(mesh, places);
    const Refinement made = before.refine();
    CHECK(made.operations.size() > 50);
    const Mesh& finer = made.mesh;
    // All are linear in the place at rest, and so are means of them.
    CHECK((finer.look.vertex_colours.topRows(3).cast<double>() - finer.vertices)
              .cwiseAbs()
              .maxCoeff() < 1e-6);
    for (std::size_t at = 0; at < finer.face_corners.size(); ++at)
      CHECK((finer.texcoords.col(finer.corner_texcoords[at]) -
             finer.vertices.col(finer.face_corners[at]).head<2>())
                .norm() < 1e-12);
    double areas[2][2] = {}; // of each material, before and after
    const auto add = [&](const Mesh& of, int when) {
      for (std::size_t face = 0; face < of.face_count(); ++face)
        for (std::uint32_t at = of.face_starts[face] + 2; at < of.face_starts[face + 1]; ++at) {
          const Vector3d first = of.vertices.col(of.face_corners[of.face_starts[face]]);
          const Vector3d second = of.vertices.col(of.face_corners[at - 1]);
          const Vector3d third = of.vertices.col(of.face_corners[at]);
          areas[of.look.face_materials[face]][when] +=
              0.5 * (second - first).cross(third - first).norm();
        }
    };
    add(mesh, 0);
    add(finer, 1);
    for (const auto& area : areas)
      CHECK(area[1] == doctest::Approx(area[0]).epsilon(0.01));
    check_repeats(before, made);
  }

  TEST_CASE("sheets that lie nearer than an edge do not come to meet") {
    std::mt19937 random(5);
    for (int round = 0; round < 8; ++round) {
      CAPTURE(round);
      const Mesh mesh = ball();
      Points places = mesh.vertices;
      std::uniform_real_distribution<double> share(0.01, 0.05);
      const double left = share(random);
      for (auto place : places.colwise()) {
        // A cake as thin as half an edge, with waves, and bent.
        place[2] *= left;
        place[2] += 0.2 * std::sin((3.0 + round) * place[0]) * std::cos(4.0 * place[1]);
        place[0] *= 1.0 + 0.1 * round;
      }
      REQUIRE_FALSE(meets_itself(mesh, places));
      const Refinement made = Shaped(mesh, places).refine();
      CHECK(made.operations.size() > 20);
      CHECK(check_closed_manifold(made.mesh));
      CHECK_FALSE(meets_itself(made.mesh, places_of(made)));
    }
  }

  TEST_CASE("all points are rounded to floats, however many there are") {
    for (std::size_t count = 0; count < 20; ++count) {
      CAPTURE(count);
      std::vector<SpacePoint> points(count);
      for (std::size_t at = 0; at < count; ++at)
        points[at] = {0.1 * static_cast<double>(at) + 0.123, -0.7 / (1.0 + static_cast<double>(at)),
                      1.0 / (3.0 + static_cast<double>(at))};
      const std::vector<SpacePoint> before = points;
      const Eigen::Matrix3Xf floats = round_points(points);
      REQUIRE(floats.cols() == static_cast<Eigen::Index>(count));
      for (std::size_t at = 0; at < count; ++at)
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const volatile float rounded = static_cast<float>(before[at][axis]);
          CHECK(points[at][axis] == static_cast<double>(rounded));
          CHECK(floats(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(at)) == rounded);
        }
    }
  }

  TEST_CASE("sheets that nearly touch do not come to meet when new vertices are rounded") {
    std::mt19937 random(6);
    int refined = 0;
    for (int round = 0; round < 60; ++round) {
      CAPTURE(round);
      const Mesh mesh = ball();
      std::uniform_real_distribution<double> logarithm(-7.0, -6.0), slope(-0.5, 0.5);
      const double left = std::pow(10.0, logarithm(random));
      const Vector3d tilt(slope(random), slope(random), 0.7);
      Points places = mesh.vertices;
      for (auto place : places.colwise()) {
        place[0] = 1.7 * place[0] + 0.3 * place[2];
        place[2] = left * place[2] + tilt[0] * place[0] + tilt[1] * place[1];
      }
      const Shaped before(mesh, places);
      const auto as_numbers = [](const Eigen::Matrix3Xf& shape) -> Points {
        return shape.cast<double>();
      };
      Eigen::Matrix3Xf numbers(3, places.cols());
      for (Eigen::Index at = 0; at < places.cols(); ++at)
        numbers.col(before.layout.order()[static_cast<std::size_t>(at)]) =
            vertex_at(before.shape, static_cast<std::size_t>(at));
      if (meets_itself(mesh, as_numbers(numbers))) continue;
      const Refinement made = before.refine();
      refined += made.operations.empty() ? 0 : 1;
      CHECK_FALSE(meets_itself(made.mesh, as_numbers(made.shape)));
    }
    CHECK(refined > 10);
  }

  TEST_CASE("the budget and the bound are kept, and the rest is done the next time") {
    const Shaped before(ball(), pulled(ball().vertices));
    const Refinement few = before.refine({.budget = 20});
    std::size_t counted = 0;
    for (const EdgeOperation& operation : few.operations)
      counted += operation.kind == EdgeOperation::Kind::flip ? 0 : 1;
    CHECK(counted == 20);
    const std::size_t most = static_cast<std::size_t>(before.mesh.vertices.cols()) + 50;
    const Refinement bounded = before.refine({.max_vertices = most});
    CHECK(static_cast<std::size_t>(bounded.mesh.vertices.cols()) <= most);
    // What is too long does not count where nothing can be done about it.
    const auto present = static_cast<std::size_t>(before.mesh.vertices.cols());
    CHECK(before.unfit({.max_vertices = present}) < before.unfit() / 10);
    Shaped now = before;
    for (int round = 0; round < 100 && now.unfit() > 20; ++round) {
      const Refinement made = now.refine({.budget = 50});
      now = Shaped(made.mesh, places_of(made));
    }
    CHECK(now.unfit() <= 20);
  }

  TEST_CASE("what is not closed is refused, with what is wrong") {
    const auto refused = Refiner::make(nendo::test::grid(4, 1.0));
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("is open at the edge") != std::string::npos);
    Mesh mesh = ball();
    mesh.vertices(1, 3) = std::nan("");
    CHECK_FALSE(Refiner::make(mesh));
  }

  TEST_CASE("whatever operations are asked for, the mesh is closed or there is an error") {
    std::mt19937 random(9);
    const Mesh mesh = nendo::test::sphere(5, 8, 1.0);
    const Mesh* const one = &mesh;
    int done = 0;
    for (int round = 0; round < 2000; ++round) {
      std::vector<EdgeOperation> operations;
      const TriangleSurface surface = surfaces_of({&one, 1}).surfaces[0];
      for (int at = 0; at < 4; ++at) {
        const Corners& face = surface.faces[random() % surface.faces.size()];
        const auto kind = static_cast<EdgeOperation::Kind>(random() % 4);
        const std::uint32_t to = random() % 8 == 0 ? static_cast<std::uint32_t>(random()) : face[1];
        operations.push_back({kind, face[0], to});
      }
      const auto made = refined(mesh, operations);
      if (!made) continue;
      ++done;
      CHECK(check_closed_manifold(*made));
      CHECK(nendo::test::euler_number(*made) == 2);
    }
    CHECK(done > 100);
  }
}

} // namespace refinement_test
