#include <nendo/deform/cut.hpp>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/cut_laws.hpp"
#include "support/nasty_meshes.hpp"
#include "support/random_blades.hpp"
#include "support/test_meshes.hpp"

namespace cut_test {

using namespace nendo;
using namespace nendo::deform;
using namespace nendo::test;

Mesh shipped(const char* name) {
  auto model = read_mesh(std::filesystem::path(NENDO_MODELS) / name);
  REQUIRE(model);
  return std::move(*model);
}

void check_laws(const Mesh& mesh, const CutModel& cut) {
  const CutFaults faults = faults_of(mesh, cut);
  CHECK(faults.open_parts == 0);
  CHECK(faults.meetings == 0);
  CHECK(faults.moved == 0);
  CHECK(faults.infinite == 0);
  CHECK(faults.volume < 1e-11);
  CHECK(faults.euler == 0);
  CHECK(cut.parts >= 2);
}

bool same_bits(const Mesh& a, const Mesh& b) {
  return a.vertices.cols() == b.vertices.cols() && a.texcoords.cols() == b.texcoords.cols() &&
         std::memcmp(a.vertices.data(), b.vertices.data(),
                     sizeof(double) * static_cast<std::size_t>(a.vertices.size())) == 0 &&
         a.face_corners == b.face_corners && a.face_starts == b.face_starts &&
         a.corner_texcoords == b.corner_texcoords && a.texcoords == b.texcoords &&
         a.look.face_materials == b.look.face_materials;
}

/// A wire along y that moves in x at the height z, from x0 to x1 and from y0 to y1.
CutWire level_wire(double x0, double x1, double y0, double y1, double z) {
  CutWire wire;
  for (int k = 0; k <= 10; ++k) {
    const double x = x0 + (x1 - x0) * k / 10.0;
    wire.places.push_back({{x, y0, z}, {x, y1, z}});
  }
  return wire;
}

TEST_SUITE("cut") {
  TEST_CASE("random planes, wires and knives through shipped and nasty models") {
    const std::pair<const char*, Mesh> models[] = {
        {"torus", torus(80, 40)},     {"thin shell", shell(24, 0.97)},
        {"cube", cube_of_cells(8)},   {"cube of squares", cube_of_cells(6, true)},
        {"comb", comb(11)},           {"sponge", sponge(2)},
        {"moai", shipped("moai.obj")}};
    std::size_t made = 0;
    for (const auto& model : models) {
      CAPTURE(model.first);
      const Mesh& mesh = model.second;
      RandomBlades blades(mesh, 17);
      for (std::uint32_t number = 0; number < 12; ++number) {
        CAPTURE(number);
        const auto cut = cut_by(mesh, blades.next(number));
        if (!cut) {
          // Some blades pass beside a model. Nothing else may keep them from cutting.
          CHECK(cut.error().message == "is not touched by the blade");
          continue;
        }
        ++made;
        check_laws(mesh, *cut);
      }
    }
    CHECK(made >= 70);
  }

  TEST_CASE("the same cut has the same bits") {
    const Mesh mesh = shipped("moai.obj");
    RandomBlades blades(mesh, 3);
    for (std::uint32_t number = 0; number < 4; ++number) {
      const AnyBlade blade = blades.next(number);
      const auto one = cut_by(mesh, blade);
      const auto other = cut_by(mesh, blade);
      REQUIRE(one);
      CHECK(same_bits(one->mesh, other->mesh));
    }
  }

  TEST_CASE("a plane in the faces of a cube, through its edges, and through its vertices") {
    const Mesh mesh = cube_of_cells(4);
    for (const Eigen::Vector3d& normal :
         {Eigen::Vector3d{0, 0, 1}, Eigen::Vector3d{0, 0, -3}, Eigen::Vector3d{1, 1, 0},
          Eigen::Vector3d{1, -1, 0}, Eigen::Vector3d{1, 1, 1}, Eigen::Vector3d{2, -1, -1}}) {
      const auto cut = cut_model(mesh, CutPlane{{0.5, 0.5, 0.5}, normal});
      REQUIRE(cut);
      check_laws(mesh, *cut);
      CHECK(cut->parts == 2);
      // The volume shows that the blade was displaced by no more than it may be.
      const auto parts = separate(*cut);
      CHECK(std::abs(volume_of(parts[0]) - volume_of(parts[1])) < 1e-5);
      CHECK(std::abs(cut->blade_offset) <= 1e-6 * std::sqrt(3.0));
    }
  }

  TEST_CASE("texture coordinates, colours, materials and names follow the surface") {
    Mesh mesh = cube_of_cells(6, true);
    // Where x < 0.5 the texture is that of an island ten units aside; seams lie between faces.
    mesh.corner_texcoords.resize(mesh.face_corners.size());
    mesh.texcoords.resize(2, 2 * mesh.vertices.cols());
    const auto count = static_cast<std::uint32_t>(mesh.vertices.cols());
    mesh.texcoords.leftCols(count) = mesh.vertices.topRows(2);
    mesh.texcoords.rightCols(count) = mesh.vertices.topRows(2).array() + 10.0;
    mesh.look.vertex_colours.resize(4, count);
    mesh.look.vertex_colours.topRows(3) = mesh.vertices.cast<float>();
    mesh.look.vertex_colours.row(3).setOnes();
    mesh.look.materials.resize(2);
    mesh.look.groups.names = {"left", "right"};
    for (std::size_t face = 0; face < mesh.face_count(); ++face) {
      const std::uint32_t begin = mesh.face_starts[face];
      const double x = mesh.vertices(0, mesh.face_corners[begin]) / 2.0 +
                       mesh.vertices(0, mesh.face_corners[begin + 2]) / 2.0;
      const std::uint32_t island = x < 0.5 ? 1 : 0;
      for (std::uint32_t at = begin; at < mesh.face_starts[face + 1]; ++at)
        mesh.corner_texcoords[at] = mesh.face_corners[at] + island * count;
      mesh.look.face_materials.push_back(island);
      mesh.look.groups.of_face.push_back(1 - island);
    }
    RandomBlades blades(mesh, 4);
    for (std::uint32_t number = 0; number < 8; ++number) {
      const auto cut = cut_by(mesh, blades.next(number));
      if (!cut) continue;
      const Mesh& after = cut->mesh;
      for (std::size_t face = 0; face < after.face_count(); ++face) {
        const bool is_cut_face = face >= cut->first_cut_face;
        CHECK((after.look.face_materials[face] == 2) == is_cut_face);
        if (is_cut_face) continue;
        const double island = after.look.face_materials[face];
        CHECK(after.look.groups.of_face[face] == 1 - after.look.face_materials[face]);
        for (std::uint32_t at = after.face_starts[face]; at < after.face_starts[face + 1]; ++at) {
          const auto vertex = static_cast<Eigen::Index>(after.face_corners[at]);
          const Eigen::Vector2d expected =
              after.vertices.col(vertex).head<2>().array() + 10.0 * island;
          const Eigen::Vector2d found = after.texcoords.col(after.corner_texcoords[at]);
          CHECK((found - expected).norm() < 1e-12);
          CHECK((after.look.vertex_colours.col(vertex).head<3>() -
                 after.vertices.col(vertex).cast<float>())
                    .norm() < 1e-6F);
        }
      }
      CHECK(after.look.materials.back().name == "cut");
      // What the blade does not cross is as it was, in its order.
      std::size_t whole = 0;
      for (std::size_t face = 0; face < cut->first_cut_face; ++face)
        whole += after.face_starts[face + 1] - after.face_starts[face] == 4 ? 1U : 0U;
      CHECK(whole > mesh.face_count() / 3);
    }
  }

  TEST_CASE("each new vertex lies on the edge that it names") {
    const Mesh mesh = shipped("spot.obj");
    RandomBlades blades(mesh, 9);
    const auto cut = cut_model(mesh, blades.wire(1.4));
    REQUIRE(cut);
    Eigen::Index at = mesh.vertices.cols();
    for (const CutVertex& vertex : cut->added) {
      if (vertex.from != no_index) {
        REQUIRE(vertex.from < at);
        REQUIRE(vertex.to < at);
        const Eigen::Vector3d expected = (1.0 - vertex.part) * cut->mesh.vertices.col(vertex.from) +
                                         vertex.part * cut->mesh.vertices.col(vertex.to);
        CHECK((cut->mesh.vertices.col(at) - expected).norm() < 1e-14);
      }
      ++at;
    }
    CHECK(at == cut->mesh.vertices.cols());
  }

  TEST_CASE("a wire cuts only what it is drawn through") {
    const Mesh mesh = comb(11); // teeth along y; those at x = 0, 2/11 and so on
    SUBCASE("two teeth") {
      const auto cut = cut_model(mesh, level_wire(-0.1, 3.5 / 11.0, -1.0, 2.0, 0.5));
      // Level with x and y, it goes through the comb's back, which it does not leave.
      REQUIRE(!cut);
      CHECK(cut.error().message == "is not cut: the blade does not go through");
      CutWire across;
      for (int k = 0; k <= 10; ++k)
        across.places.push_back({{-0.05 + 0.033 * k, 0.7, -1.0}, {-0.05 + 0.033 * k, 0.7, 2.0}});
      const auto teeth = cut_model(mesh, across);
      REQUIRE(teeth);
      check_laws(mesh, *teeth);
      CHECK(teeth->parts == 3);
      CHECK(teeth->loops == 2);
      CHECK(teeth->uncut_loops == 4);
    }
    SUBCASE("one that stops inside leaves the model whole") {
      const auto cut = cut_model(cube_of_cells(4), level_wire(-1.0, 0.6, -1.0, 2.0, 0.4));
      REQUIRE(!cut);
      CHECK(cut.error().message == "is not cut: the blade does not go through");
    }
    SUBCASE("one that goes through one side of a ring") {
      const auto cut = cut_model(torus(40, 20), level_wire(0.0, 2.0, -1.0, 1.0, 0.0));
      REQUIRE(!cut);
      const auto across = cut_model(torus(40, 20), CutWire{{{{0.3, 0.0, -1.0}, {0.3, 0.0, 1.0}},
                                                            {{2.0, 0.0, -1.0}, {2.0, 0.0, 1.0}}}});
      REQUIRE(!across);
      CHECK(across.error().message ==
            "is not cut: the blade opens a ring of it, but no part comes off");
    }
    SUBCASE("a hollow alone is not filled") {
      // The wire reaches through the hollow, but not through the wall around it.
      const auto cut = cut_model(shell(24, 0.5), level_wire(-0.7, 0.7, -0.7, 0.7, 0.01));
      REQUIRE(!cut);
      CHECK(cut.error().message == "is not cut: the blade does not go through");
    }
  }

  TEST_CASE("what cannot be cut says why") {
    const Mesh ball = sphere(8, 12, 1.0);
    const auto why = [](const Result<CutModel>& cut) {
      REQUIRE(!cut);
      return std::pair(cut.error().code, cut.error().message);
    };
    const auto [code, message] =
        why(cut_model(shipped("head.obj"), CutPlane{{0, 0, 0}, {0, 0, 1}}));
    CHECK(code == Errc::bad_input);
    CHECK(message.starts_with("is open at the edge between ("));
    CHECK(why(cut_model(ball, CutPlane{{0, 0, 0}, {0, 0, 0}})).first == Errc::usage);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    CHECK(why(cut_model(ball, CutPlane{{0, nan, 0}, {0, 0, 1}})).first == Errc::usage);
    CHECK(why(cut_model(ball, CutWire{})).first == Errc::usage);
    const WirePlace still{{0, -2, 0}, {0, 2, 0}};
    CHECK(why(cut_model(ball, CutWire{{still, still}})).first == Errc::usage);
    CHECK(why(cut_model(ball, CutWire{{still, {{1, 0, 0}, {1, 0, 0}}}})).first == Errc::usage);
    CHECK(why(cut_model(ball, CutPlane{{0, 0, 7}, {0, 0, 1}})).first == Errc::failed);
    CHECK(why(cut_model(Mesh{}, CutPlane{{0, 0, 0}, {0, 0, 1}})).first == Errc::bad_input);
    Mesh huge = ball;
    huge.vertices *= 1e80;
    CHECK(why(cut_model(huge, CutPlane{{0, 0, 0}, {0, 0, 1}})).first == Errc::bad_input);
    Mesh broken = ball;
    broken.vertices(1, 3) = nan;
    CHECK(why(cut_model(broken, CutPlane{{0, 0, 0}, {0, 0, 1}})).first == Errc::bad_input);
  }

  TEST_CASE("faces whose triangles touch along one line are refused") {
    Mesh spindle; // three quads from tip to tip, whose diagonals all are its axis
    spindle.vertices.resize(3, 5);
    spindle.vertices << 0, 0, 1, -0.5, -0.5, 0, 0, 0, 0.9, -0.9, 1, -1, 0, 0.05, 0.1;
    for (std::uint32_t k = 0; k < 3; ++k)
      add_face(spindle, {0, 2 + k, 1, 2 + (k + 1) % 3});
    REQUIRE(check_closed_manifold(spindle));
    const auto by_plane = cut_model(spindle, CutPlane{{0, 0, 0.1}, {0.1, 0.2, 1}});
    REQUIRE_FALSE(by_plane);
    CHECK(by_plane.error().code == Errc::failed);
    CutWire bent;
    for (int k = -10; k <= 10; ++k) {
      const double x = 0.2 * k, height = 0.3 * x * x;
      bent.places.push_back({{x, -3, height - 0.1}, {x, 3, height + 0.05}});
    }
    const auto by_wire = cut_model(spindle, bent);
    REQUIRE_FALSE(by_wire);
    CHECK(by_wire.error().code == Errc::failed);
  }

  TEST_CASE("a wire that turns back on itself is refused or cuts soundly") {
    const Mesh ball = sphere(20, 30, 1.0);
    CutWire wire;
    for (int k = 0; k <= 40; ++k) {
      const double turn = 0.3 * k;
      const Eigen::Vector3d at{0.9 * std::cos(turn), 0.9 * std::sin(turn), -0.8 + 0.04 * k};
      wire.places.push_back({at - Eigen::Vector3d{0, 3, 1}, at + Eigen::Vector3d{0, 3, 1}});
    }
    const auto cut = cut_model(ball, wire);
    if (cut) check_laws(ball, *cut);
    CHECK((cut || cut.error().code == Errc::failed));
  }
}

} // namespace cut_test
