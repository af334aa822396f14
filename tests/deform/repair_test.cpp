#include <nendo/deform/repair.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <utility>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/mesh_file.hpp>

#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"

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

/// Vertices - edges + faces: 2 for each ball, 0 for a torus. Of a closed model of triangles.
long euler_characteristic(const Mesh& mesh) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    for (std::uint32_t at = mesh.face_starts[face]; at < mesh.face_starts[face + 1]; ++at) {
      const std::uint32_t next =
          at + 1 < mesh.face_starts[face + 1] ? at + 1 : mesh.face_starts[face];
      edges.insert(std::minmax(mesh.face_corners[at], mesh.face_corners[next]));
    }
  return static_cast<long>(mesh.vertices.cols()) - static_cast<long>(edges.size()) +
         static_cast<long>(mesh.face_count());
}

/// Appends another mesh, whose vertices stay its own.
void append(Mesh& mesh, const Mesh& more) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.cols());
  Points both(3, mesh.vertices.cols() + more.vertices.cols());
  both << mesh.vertices, more.vertices;
  mesh.vertices = both;
  for (const std::uint32_t corner : more.face_corners)
    mesh.face_corners.push_back(corner + first);
  for (std::size_t face = 0; face < more.face_count(); ++face)
    mesh.face_starts.push_back(mesh.face_starts.back() + more.face_starts[face + 1] -
                               more.face_starts[face]);
}

Mesh reversed(Mesh mesh) {
  for (std::size_t face = 0; face < mesh.face_count(); ++face)
    std::reverse(mesh.face_corners.begin() + mesh.face_starts[face],
                 mesh.face_corners.begin() + mesh.face_starts[face + 1]);
  return mesh;
}

/// Vertices in one place become one, as a program does that knows nothing of touching.
Mesh merged(const Mesh& mesh) {
  Mesh made = mesh;
  std::map<std::array<double, 3>, std::uint32_t> known;
  std::vector<Eigen::Vector3d> places;
  for (std::uint32_t& corner : made.face_corners) {
    const Eigen::Vector3d at = mesh.vertices.col(corner);
    const auto next = static_cast<std::uint32_t>(known.size());
    const auto [found, is_new] = known.emplace(std::array{at.x(), at.y(), at.z()}, next);
    if (is_new) places.push_back(at);
    corner = found->second;
  }
  made.vertices.resize(3, static_cast<Eigen::Index>(places.size()));
  for (std::size_t at = 0; at < places.size(); ++at)
    made.vertices.col(static_cast<Eigen::Index>(at)) = places[at];
  return made;
}

/// 24 quads about the z axis.
Mesh moebius_strip(double size) {
  Mesh strip;
  constexpr std::uint32_t around = 24;
  strip.vertices.resize(3, 2 * around);
  for (std::uint32_t at = 0; at < around; ++at) {
    const double turn = 2.0 * std::numbers::pi * at / around;
    for (std::uint32_t side = 0; side < 2; ++side) {
      const double out = (side == 0 ? -0.3 : 0.3);
      const double radius = 1.0 + out * std::cos(turn / 2.0);
      strip.vertices.col(2 * at + side) << radius * std::cos(turn), radius * std::sin(turn),
          out * std::sin(turn / 2.0);
    }
    const bool last = at + 1 == around;
    const std::uint32_t next = last ? 0 : 2 * at + 2;
    add_face(strip, {2 * at, 2 * at + 1, next + (last ? 0U : 1U), next + (last ? 1U : 0U)});
  }
  strip.vertices *= size;
  return strip;
}

TEST_SUITE("repair") {
  TEST_CASE("a model without faults comes back to the bit") {
    Mesh textured = torus(12, 8);
    textured.texcoords = textured.vertices.topRows<2>();
    textured.corner_texcoords = textured.face_corners;
    textured.look.vertex_colours = Eigen::Matrix4Xf::Random(4, textured.vertices.cols());
    Mesh two = cube_of_cells(2, true);
    append(two, moved(torus(9, 7), {4, 0, 0}));
    for (const Mesh& whole : {textured, two, shell(6, 0.5), sponge(1)}) {
      const auto fixed = repair(whole);
      REQUIRE_MESSAGE(fixed, fixed.error().message);
      CHECK(lines_of(*fixed).empty());
      CHECK(fixed->mesh.vertices == whole.vertices);
      CHECK(fixed->mesh.face_corners == whole.face_corners);
      CHECK(fixed->mesh.face_starts == whole.face_starts);
      CHECK(fixed->mesh.texcoords == whole.texcoords);
      CHECK(fixed->mesh.corner_texcoords == whole.corner_texcoords);
      CHECK(fixed->mesh.look.vertex_colours == whole.look.vertex_colours);
    }
  }

  TEST_CASE("vertices that rounding put apart become one, and others within a tolerance") {
    std::mt19937 random(7);
    for (const double noise : {1e-6, 1e-3}) {
      Mesh broken = unshared(cube_of_cells(3));
      std::uniform_real_distribution<double> way(-noise, noise);
      for (double& number : broken.vertices.reshaped())
        number += way(random);
      RepairOptions options;
      if (noise > 1e-5) options.tolerance = 4.0 * noise;
      const auto fixed = repair(broken, options);
      REQUIRE_MESSAGE(fixed, fixed.error().message);
      CHECK(check_closed_manifold(fixed->mesh));
      CHECK(fixed->mesh.vertices.cols() == 56);
      CHECK(euler_characteristic(fixed->mesh) == 2);
      CHECK(volume_of(fixed->mesh) == doctest::Approx(1.0).epsilon(10.0 * noise));
      if (noise > 1e-5) CHECK(!repair(broken)); // by default, they are too far apart
    }
  }

  TEST_CASE("a face that is there twice does not keep its edges from being joined") {
    Mesh loose = unshared(cube_of_cells(2));
    add_face(loose, {loose.face_corners[0], loose.face_corners[1], loose.face_corners[2]});
    add_face(loose, {loose.face_corners[5], loose.face_corners[4], loose.face_corners[3]});
    const auto fixed = repair(loose);
    REQUIRE_MESSAGE(fixed, fixed.error().message);
    CHECK(fixed->dropped == 2);
    CHECK(fixed->mesh.vertices.cols() == 26);
    CHECK(volume_of(fixed->mesh) == doctest::Approx(1.0).epsilon(1e-12));
  }

  TEST_CASE("surfaces that touch in a point, or at an edge, are separated") {
    const Mesh cube = cube_of_cells(2);
    for (const Eigen::Vector3d& way : {Eigen::Vector3d(1, 1, 1), Eigen::Vector3d(1, 1, 0)}) {
      Mesh both = cube;
      append(both, moved(cube, way));
      const Mesh touching = merged(both);
      CHECK(!check_closed_manifold(touching));
      const auto fixed = repair(touching);
      REQUIRE_MESSAGE(fixed, fixed.error().message);
      CHECK(check_closed_manifold(fixed->mesh));
      CHECK(fixed->separated == (way.z() > 0.5 ? 1U : 3U)); // an edge of two cells
      CHECK(euler_characteristic(fixed->mesh) == 4);        // two balls
      CHECK(volume_of(fixed->mesh) == doctest::Approx(2.0).epsilon(1e-12));
      CHECK(separate(fixed->mesh).size() == 2);
      // And so, if all faces have vertices of their own, whichever way one of both faces.
      Mesh loose = unshared(cube);
      append(loose, unshared(reversed(moved(cube, way))));
      const auto again = repair(loose);
      REQUIRE_MESSAGE(again, again.error().message);
      CHECK(check_closed_manifold(again->mesh));
      CHECK(volume_of(again->mesh) == doctest::Approx(2.0).epsilon(1e-12));
    }
  }

  TEST_CASE("walls of two bodies stay, and a face that is there twice goes") {
    Mesh both = cube_of_cells(2, true);
    append(both, moved(cube_of_cells(2, true), {1, 0, 0}));
    const auto walls = repair(unshared(both));
    REQUIRE_MESSAGE(walls, walls.error().message);
    CHECK(walls->dropped == 0);
    CHECK(separate(walls->mesh).size() == 2);
    CHECK(volume_of(walls->mesh) == doctest::Approx(2.0).epsilon(1e-12));
    for (const bool turns : {false, true}) {
      Mesh twice = cube_of_cells(2);
      append(twice, turns ? reversed(cube_of_cells(2)) : cube_of_cells(2));
      const auto once = repair(unshared(twice));
      REQUIRE_MESSAGE(once, once.error().message);
      CHECK(once->dropped == 48);
      CHECK(volume_of(once->mesh) == doctest::Approx(1.0).epsilon(1e-12));
    }
  }

  TEST_CASE("each part is turned outwards, and cavities stay cavities") {
    const Mesh hollow = shell(8, 0.5);
    const double volume = volume_of(hollow);
    Mesh mixed = reversed(hollow);
    append(mixed, moved(reversed(cube_of_cells(2)), {3, 0, 0}));
    append(mixed, moved(cube_of_cells(2), {6, 0, 0}));
    const auto fixed = repair(mixed);
    REQUIRE_MESSAGE(fixed, fixed.error().message);
    CHECK(fixed->turned == hollow.face_count() + 48);
    CHECK(volume_of(fixed->mesh) == doctest::Approx(volume + 2.0).epsilon(1e-12));
    CHECK(lines_of(*repair(hollow)).empty());
  }

  TEST_CASE("a hole of a hundred corners is closed, flat or waved") {
    for (const double waves : {0.0, 0.2}) {
      // A tube with a floor: the rim is open.
      constexpr std::uint32_t around = 100;
      Mesh tube;
      tube.vertices.resize(3, 2 * around + 1);
      for (std::uint32_t at = 0; at < around; ++at) {
        const double turn = 2.0 * std::numbers::pi * at / around;
        const double height = 1.0 + waves * std::sin(3.0 * turn);
        tube.vertices.col(at) << std::cos(turn), 0.0, -std::sin(turn);
        tube.vertices.col(around + at) << std::cos(turn), height, -std::sin(turn);
      }
      tube.vertices.col(2 * around).setZero();
      for (std::uint32_t at = 0; at < around; ++at) {
        const std::uint32_t next = (at + 1) % around;
        add_face(tube, {at, next, around + next, around + at});
        add_face(tube, {next, at, 2 * around});
      }
      const auto fixed = repair(tube);
      REQUIRE_MESSAGE(fixed, fixed.error().message);
      CHECK(fixed->filled == 1);
      CHECK(fixed->filled_crossing == 0);
      CHECK(check_closed_manifold(fixed->mesh));
      const double base = 0.5 * around * std::sin(2.0 * std::numbers::pi / around);
      CHECK(volume_of(fixed->mesh) == doctest::Approx(base).epsilon(waves > 0.0 ? 0.2 : 1e-9));
      CHECK(fixed->mesh.vertices == tube.vertices);
    }
  }

  TEST_CASE("a vertex in an edge of another face splits that edge") {
    Mesh cube = cube_of_cells(1);
    // The top's two triangles meet four others at an edge that has its middle.
    Mesh broken;
    broken.vertices.resize(3, 9);
    broken.vertices.leftCols<8>() = cube.vertices;
    std::size_t split = cube.face_count();
    for (std::size_t face = 0; face < cube.face_count(); ++face) {
      const std::uint32_t* const corner = &cube.face_corners[3 * face];
      if (split == cube.face_count() &&
          (cube.vertices.col(corner[0]) - cube.vertices.col(corner[1])).norm() < 1.1) {
        split = face;
        broken.vertices.col(8) =
            0.5 * (cube.vertices.col(corner[0]) + cube.vertices.col(corner[1]));
        add_face(broken, {corner[0], 8, corner[2]});
        add_face(broken, {8, corner[1], corner[2]});
        continue;
      }
      add_face(broken, {corner[0], corner[1], corner[2]});
    }
    REQUIRE(!check_closed_manifold(broken));
    const auto fixed = repair(broken);
    REQUIRE_MESSAGE(fixed, fixed.error().message);
    CHECK(fixed->split == 1);
    CHECK(fixed->filled == 0);
    CHECK(check_closed_manifold(fixed->mesh));
    CHECK(volume_of(fixed->mesh) == doctest::Approx(1.0).epsilon(1e-12));
  }

  TEST_CASE("a face whose last corner is its first again loses it, and it is said") {
    Mesh mesh = cube_of_cells(1, true);
    const Mesh whole = mesh;
    mesh.face_corners.insert(mesh.face_corners.begin() + 4, mesh.face_corners[0]);
    for (std::size_t face = 1; face < mesh.face_starts.size(); ++face)
      ++mesh.face_starts[face];
    CHECK(!check_closed_manifold(mesh));
    const auto fixed = repair(mesh);
    REQUIRE_MESSAGE(fixed, fixed.error().message);
    CHECK(fixed->repeated == 1);
    CHECK(check_closed_manifold(fixed->mesh));
    CHECK(fixed->mesh.face_starts == whole.face_starts);
    CHECK(volume_of(fixed->mesh) == doctest::Approx(1.0).epsilon(1e-14));
  }

  TEST_CASE("vertices without a face go, and it is said") {
    Mesh mesh = torus(12, 8);
    mesh.vertices.conservativeResize(3, mesh.vertices.cols() + 2);
    mesh.vertices.rightCols<2>().setConstant(1000.0);
    const auto fixed = repair(mesh);
    REQUIRE(fixed);
    CHECK(fixed->mesh.vertices == torus(12, 8).vertices);
    CHECK(lines_of(*fixed) == std::vector<std::string>{"dropped 2 vertices without a face"});
  }

  TEST_CASE("a loose flap is left out, and the rest is repaired") {
    const Mesh cube = cube_of_cells(2);
    const auto check = [&](const Mesh& mesh, std::size_t faces) {
      const auto fixed = repair(mesh);
      REQUIRE_MESSAGE(fixed, fixed.error().message);
      CHECK(check_closed_manifold(fixed->mesh));
      CHECK(volume_of(fixed->mesh) == doctest::Approx(1.0).epsilon(1e-12));
      CHECK(fixed->mesh.vertices.cols() == 26);
      CHECK(fixed->stray == 0);
      CHECK(fixed->separated == 0);
      REQUIRE(fixed->left_out.size() == 1);
      CHECK(fixed->left_out[0].faces == faces);
      const std::vector<std::string> lines = lines_of(*fixed);
      CHECK(lines.back().starts_with("left out " + std::to_string(faces) + " face"));
      return lines.back();
    };
    // On an edge, outside or inside, whichever way it faces.
    for (const double height : {0.7, -0.2})
      for (const bool turns : {false, true}) {
        Mesh finned = cube;
        const std::uint32_t a = cube.face_corners[0], b = cube.face_corners[1];
        const Eigen::Vector3d middle = 0.5 * (cube.vertices.col(a) + cube.vertices.col(b));
        const Eigen::Vector3d out = middle - Eigen::Vector3d::Constant(0.5);
        finned.vertices.conservativeResize(3, 27);
        finned.vertices.col(26) = middle + height * out;
        add_face(finned, {turns ? b : a, turns ? a : b, 26});
        CHECK(check(finned, 1).find("it is a sheet without an inside") != std::string::npos);
      }
    // Two sheets apart from the cube, and a one-sided one.
    Mesh sheets = without_faces(cube, 3, 1);
    append(sheets, moved(grid(2, 0.1), {3, 0, 0}));
    append(sheets, moved(grid(2, 0.1), {4, 0, 0}));
    const std::size_t faces = 2 * grid(2, 0.1).face_count();
    CHECK(check(sheets, faces).find(" in 2 parts, the first at (") != std::string::npos);
    Mesh with_strip = cube;
    append(with_strip, moved(moebius_strip(0.1), {3, 0, 0}));
    CHECK(check(with_strip, 24).find("one side only") != std::string::npos);
  }

  TEST_CASE("too many open edges to look for vertices in them are reported") {
    // Thin slivers, each as long as all others: so each edge is compared with each vertex.
    Mesh mesh = cube_of_cells(1);
    constexpr int slivers = 7000;
    const auto first = static_cast<std::uint32_t>(mesh.vertices.cols());
    mesh.vertices.conservativeResize(3, first + 3 * slivers);
    for (std::uint32_t at = 0; at < slivers; ++at) {
      const double height = 2.0 + 0.01 * at;
      mesh.vertices.col(first + 3 * at) << 0.0, height, 0.0;
      mesh.vertices.col(first + 3 * at + 1) << 1.0, height, 0.0;
      mesh.vertices.col(first + 3 * at + 2) << 0.5, height, 1e-3;
      add_face(mesh, {first + 3 * at, first + 3 * at + 1, first + 3 * at + 2});
    }
    const auto fixed = repair(mesh, {.tolerance = 1e-9});
    REQUIRE_MESSAGE(fixed, fixed.error().message);
    CHECK(fixed->skipped_junctions);
    CHECK(lines_of(*fixed).back().starts_with("has too many open edges"));
    CHECK_FALSE(repair(cube_of_cells(1))->skipped_junctions);
  }

  TEST_CASE("faces that look inwards are counted as they are turned, and cavities are not") {
    CHECK(count_inward_faces(shell(6, 0.5)) == 0);
    Mesh inwards = reversed(shell(6, 0.5));
    append(inwards, moved(cube_of_cells(2), {3, 0, 0}));
    const double volume = volume_of(shell(6, 0.5)) + 1.0;
    CHECK(count_inward_faces(inwards) == shell(6, 0.5).face_count());
    CHECK(turn_outwards(inwards) == shell(6, 0.5).face_count());
    CHECK(volume_of(inwards) == doctest::Approx(volume).epsilon(1e-12));
    CHECK(count_inward_faces(inwards) == 0);
  }

  TEST_CASE("sheets, one-sided surfaces and surfaces laid double are refused with the reason") {
    const auto refusal = [](const Mesh& mesh) {
      const auto fixed = repair(mesh);
      REQUIRE(!fixed);
      CHECK(fixed.error().code == nendo::Errc::bad_input);
      CHECK(fixed.error().message.starts_with("cannot be repaired: "));
      return fixed.error().message;
    };
    const Mesh sheet = grid(4, 1.0);
    CHECK(refusal(sheet).find("is a sheet without an inside") != std::string::npos);
    Mesh laid_double = sheet;
    append(laid_double, reversed(sheet));
    CHECK(refusal(unshared(laid_double)).find("is a sheet") != std::string::npos);
    CHECK(refusal(moebius_strip(1.0)).find("one side only") != std::string::npos);
  }

  TEST_CASE("vertices in one place are joined, and turned faces turn back") {
    for (const Mesh& whole : {torus(20, 10), cube_of_cells(3, true), comb(5)}) {
      Mesh broken = unshared(whole);
      for (std::size_t face = 0; face < broken.face_count(); face += 3)
        std::reverse(broken.face_corners.begin() + broken.face_starts[face],
                     broken.face_corners.begin() + broken.face_starts[face + 1]);
      CHECK(!check_closed_manifold(broken));
      const auto fixed = repair(broken);
      REQUIRE(fixed);
      CHECK(check_closed_manifold(fixed->mesh));
      CHECK(volume_of(fixed->mesh) == doctest::Approx(volume_of(whole)).epsilon(1e-12));
      CHECK(fixed->filled == 0);
      CHECK(fixed->mesh.vertices.cols() == whole.vertices.cols());
      CHECK(fixed->joined ==
            whole.face_corners.size() - static_cast<std::size_t>(whole.vertices.cols()));
      CHECK(fixed->turned == (broken.face_count() + 2) / 3);
      CHECK(fixed->mesh.face_count() == whole.face_count());
    }
  }

  TEST_CASE("holes are filled: of a cube so that its volume comes back") {
    const Mesh cube = cube_of_cells(4);
    const Mesh open = without_faces(cube, 10, 7);
    const auto fixed = repair(open);
    REQUIRE(fixed);
    CHECK(fixed->filled >= 1);
    CHECK(check_closed_manifold(fixed->mesh));
    CHECK(volume_of(fixed->mesh) == doctest::Approx(1.0).epsilon(0.05));
    CHECK(volume_of(repair(cube)->mesh) == doctest::Approx(1.0).epsilon(1e-14));
  }

  TEST_CASE("doubles and faces without area are dropped") {
    Mesh mesh = torus(12, 8);
    const std::size_t faces = mesh.face_count();
    add_face(mesh, {mesh.face_corners[0], mesh.face_corners[1], mesh.face_corners[2]});
    add_face(mesh, {3, 4, 4});
    add_face(mesh, {5, 6});
    const auto fixed = repair(mesh);
    REQUIRE(fixed);
    CHECK(fixed->dropped == 3);
    CHECK(fixed->mesh.face_count() == faces);
    CHECK(lines_of(*fixed) ==
          std::vector<std::string>{
              "dropped 3 faces that had fewer than three corners or repeated another"});
  }

  TEST_CASE("the shipped head, open at the neck, can be cut when it is repaired") {
    const auto head = read_mesh(std::filesystem::path(NENDO_MODELS) / "head.obj");
    REQUIRE(head);
    const auto fixed = repair(*head);
    if (!fixed) {
      MESSAGE(fixed.error().message);
      CHECK(fixed.error().message.starts_with("cannot be repaired: "));
      return;
    }
    CHECK(check_closed_manifold(fixed->mesh));
    const Eigen::Vector3d middle = head->vertices.rowwise().mean();
    CHECK(cut_model(fixed->mesh, CutPlane{middle, {0.1, 1.0, 0.2}}));
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
    const auto fixed = repair(mesh);
    REQUIRE(!fixed);
    CHECK(fixed.error().code == nendo::Errc::bad_input);
    CHECK(fixed.error().message.starts_with("cannot be repaired"));
  }
}

} // namespace repair_test
