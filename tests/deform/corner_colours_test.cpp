// Faces of a vertex that differ in colour keep their colours, whatever is done to the model.

#include <nendo/deform/corner_colours.hpp>

#include <array>
#include <string>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>
#include <nendo/deform/edit_part.hpp>
#include <nendo/deform/join.hpp>
#include <nendo/deform/mesh_file.hpp>
#include <nendo/deform/refinement.hpp>
#include <nendo/deform/repair.hpp>
#include <nendo/deform/subdivision.hpp>

#include "repair/weld.hpp"
#include "support/nasty_meshes.hpp"
#include "support/placed_meshes.hpp"
#include "support/six_colours.hpp"
#include "support/temporary_folder.hpp"

namespace corner_colours_test {

using namespace nendo;
using namespace nendo::deform;
using namespace nendo::test;

constexpr float rounding = 1e-6F;

TEST_SUITE("corner_colours") {
  TEST_CASE("vertices of one place become one, though their colours differ") {
    for (const bool textured : {false, true}) {
      CAPTURE(textured);
      Mesh loose = soup_of_six_colours(cube_of_cells(2, true));
      if (textured) {
        loose.texcoords = loose.vertices.topRows<2>();
        loose.corner_texcoords = loose.face_corners;
      }
      CHECK(weld_places(loose) == 96 - 26);
      CHECK(check_closed_manifold(loose));
      CHECK(loose.look.vertex_colours.cols() == 0);
      CHECK(worst_of_six_colours(loose) == 0.0F);
      CHECK(has_texture_places(loose) == textured);
      for (std::size_t at = 0; textured && at < loose.face_corners.size(); ++at)
        CHECK(loose.texcoords.col(loose.corner_texcoords[at]) ==
              loose.vertices.col(loose.face_corners[at]).head<2>());
    }
  }

  TEST_CASE("vertices of one place and one colour keep colours of vertices") {
    Mesh loose = soup_of_six_colours(cube_of_cells(1));
    loose.look.vertex_colours.setConstant(0.5F);
    CHECK(weld_places(loose) == 36 - 8);
    CHECK(loose.look.vertex_colours == Eigen::Matrix4Xf::Constant(4, 8, 0.5F));
    CHECK(loose.look.texcoord_colours.cols() == 0);
  }

  TEST_CASE("repair joins what lies a little apart, and turns and fills") {
    Mesh loose = soup_of_six_colours(cube_of_cells(3));
    loose.vertices += 1e-7 * Points::Random(3, loose.vertices.cols());
    const auto fixed = repair(loose);
    REQUIRE_MESSAGE(fixed, fixed.error().message);
    CHECK(check_closed_manifold(fixed->mesh));
    CHECK(worst_of_six_colours(fixed->mesh) == 0.0F);
  }

  TEST_CASE("finer faces have the colours of the faces that they were") {
    const Mesh coloured = with_six_colours(cube_of_cells(2, true));
    const Mesh finer = subdivide(subdivide(coloured).mesh).mesh;
    CHECK(finer.face_count() == 16 * coloured.face_count());
    CHECK(worst_of_six_colours(finer) < rounding);
  }

  TEST_CASE("refining keeps them, and so does repeating it") {
    const Mesh coloured = with_six_colours(cube_of_cells(4));
    Points pulled = coloured.vertices;
    for (auto place : pulled.colwise())
      if (place.x() > 0.9) place.x() += 1.5;
    const BlockLayout layout(coloured.vertices);
    Eigen::Matrix3Xf numbers(3, pulled.cols());
    for (Eigen::Index at = 0; at < pulled.cols(); ++at)
      numbers.col(at) = ((pulled.col(at) - layout.origin()) / layout.unit()).cast<float>();
    const auto refiner = Refiner::make(coloured);
    REQUIRE(refiner);
    const Refinement made = refiner->refine(shape_in_blocks(numbers, layout), layout, {});
    CHECK(made.mesh.vertices.cols() > coloured.vertices.cols() + 100);
    CHECK(worst_of_six_colours(made.mesh) < rounding);
    const auto again = refined(coloured, made.operations);
    REQUIRE(again);
    CHECK(again->look.texcoord_colours == made.mesh.look.texcoord_colours);
  }

  TEST_CASE("a cut model keeps them, its cut faces are white, and so do its parts") {
    const Mesh coloured = with_six_colours(cube_of_cells(3));
    const auto cut = cut_model(coloured, CutPlane{{0.4, 0.5, 0.5}, {1.0, 0.3, 0.2}});
    REQUIRE(cut);
    const auto is_cap = [&](const Mesh& mesh) {
      return [&](std::size_t face) { return mesh.look.face_materials[face] != no_index; };
    };
    for (const Mesh& part : separate(*cut)) {
      const auto cap = is_cap(part);
      CHECK(worst_of_six_colours(part, [&](std::size_t face) { return !cap(face); }) < rounding);
      for (std::size_t face = 0; face < part.face_count(); ++face)
        for (std::uint32_t at = part.face_starts[face]; at < part.face_starts[face + 1]; ++at)
          if (cap(face))
            CHECK(part.look.texcoord_colours.col(part.corner_texcoords[at]).isOnes(0.0F));
    }
  }

  TEST_CASE("joined models keep them, whether the other one has colours of vertices or none") {
    const Mesh coloured = with_six_colours(cube_of_cells(2));
    Mesh other = moved(cube_of_cells(2), {0.65, 0.2, 0.15});
    for (const bool vertices : {false, true}) {
      CAPTURE(vertices);
      if (vertices) other.look.vertex_colours = Eigen::Matrix4Xf::Constant(4, 26, 0.25F);
      const JoinPart two[] = {{&coloured, "a"}, {&other, "b"}};
      const auto joined = join(two, {});
      REQUIRE_MESSAGE(joined, joined.error().message);
      const Mesh& mesh = joined->mesh;
      REQUIRE(mesh.look.texcoord_colours.cols() == mesh.texcoords.cols());
      for (std::size_t face = 0; face < mesh.face_count(); ++face) {
        Eigen::Vector3d middle = Eigen::Vector3d::Zero();
        for (std::size_t at = 3 * face; at < 3 * face + 3; ++at)
          middle += mesh.vertices.col(mesh.face_corners[at]) / 3.0;
        const bool is_first = middle.minCoeff() > -1e-6 && middle.maxCoeff() < 1.0 + 1e-6 &&
                              (middle.minCoeff() < 1e-6 || middle.maxCoeff() > 1.0 - 1e-6);
        const Eigen::Vector4f wanted =
            is_first ? colour_of_side(side_of(area_of_face(mesh, face)))
                     : Eigen::Vector4f(Eigen::Vector4f::Constant(vertices ? 0.25F : 1.0F));
        for (std::size_t at = 3 * face; at < 3 * face + 3; ++at)
          CHECK((mesh.look.texcoord_colours.col(mesh.corner_texcoords[at]) - wanted)
                    .cwiseAbs()
                    .maxCoeff() < rounding);
      }
    }
  }

  TEST_CASE("models side by side: colours of corners, of vertices, and none") {
    const Mesh coloured = with_six_colours(cube_of_cells(1));
    Mesh grey = cube_of_cells(1);
    grey.look.vertex_colours = Eigen::Matrix4Xf::Constant(4, 8, 0.25F);
    const auto all = side_by_side(std::array{cube_of_cells(1), coloured, grey});
    REQUIRE(all);
    CHECK(all->look.vertex_colours.cols() == 0);
    const auto is_second = [](std::size_t face) { return face / 12 == 1; };
    CHECK(worst_of_six_colours(*all, is_second) == 0.0F);
    for (std::size_t at = 0; at < all->face_corners.size(); ++at)
      if (at / 36 != 1)
        CHECK(all->look.texcoord_colours.col(all->corner_texcoords[at]) ==
              Eigen::Vector4f::Constant(at / 36 == 0 ? 1.0F : 0.25F));
  }

  TEST_CASE("OBJ and PLY get means, and say so") {
    const Mesh coloured = with_six_colours(cube_of_cells(1, true));
    CHECK(count_colour_seams(coloured) == 8);
    const TemporaryFolder folder;
    for (const char* name : {"cube.obj", "cube.ply"}) {
      const auto path = folder.path() / name;
      CHECK(lost_in_file(path, coloured) ==
            std::vector<std::string>{
                "OBJ and PLY have one colour for each vertex, so 8 vertices get the mean of the "
                "faces' colours there"});
      REQUIRE(write_mesh(path, coloured));
      const auto back = read_mesh(path);
      REQUIRE(back);
      CHECK(back->corner_texcoords.empty());
      REQUIRE(back->look.vertex_colours.cols() == 8);
      for (Eigen::Index at = 0; at < 8; ++at) {
        Eigen::Vector3f sum = Eigen::Vector3f::Zero();
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
          const bool up = coloured.vertices(axis, at) > 0.5;
          sum += colour_of_side(static_cast<std::uint32_t>(2 * axis + (up ? 1 : 0))).head<3>();
        }
        CHECK((back->look.vertex_colours.col(at).head<3>() - sum / 3.0F).cwiseAbs().maxCoeff() <
              0.005F); // a PLY has 8 bits
      }
    }
  }
}

} // namespace corner_colours_test
