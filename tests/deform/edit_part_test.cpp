// Copies of parts, and what is left without one.

#include <nendo/deform/edit_part.hpp>

#include <doctest/doctest.h>

#include <nendo/deform/closed_manifold.hpp>
#include <nendo/deform/cut.hpp>

#include "support/test_meshes.hpp"

namespace edit_part_test {

using namespace nendo;
using namespace nendo::deform;

namespace {

/// Two balls of which the second has another material, with colours and texture coordinates.
Mesh two_balls() {
  const Mesh ball = test::sphere(9, 16, 1.0);
  const auto count = static_cast<std::uint32_t>(ball.vertices.cols());
  Mesh both = ball;
  both.vertices.conservativeResize(3, 2 * count);
  both.vertices.rightCols(count) = ball.vertices.colwise() + Eigen::Vector3d(0.3, 5.0, 0.1);
  both.look.materials.resize(2);
  both.look.materials[0].name = "clay";
  both.look.materials[1].name = "stone";
  both.look.face_materials.assign(ball.face_count(), 0);
  both.look.objects.names = {"lower", "upper"};
  both.look.objects.of_face.assign(ball.face_count(), 0);
  for (std::size_t face = 0; face < ball.face_count(); ++face) {
    for (std::uint32_t at = ball.face_starts[face]; at < ball.face_starts[face + 1]; ++at)
      both.face_corners.push_back(count + ball.face_corners[at]);
    both.face_starts.push_back(static_cast<std::uint32_t>(both.face_corners.size()));
    both.look.face_materials.push_back(1);
    both.look.objects.of_face.push_back(1);
  }
  both.texcoords = both.vertices.topRows<2>();
  both.corner_texcoords = both.face_corners;
  both.look.vertex_colours.resize(4, 2 * count);
  both.look.vertex_colours.topRows<3>() = both.vertices.cast<float>();
  both.look.vertex_colours.row(3).setOnes();
  return both;
}

/// Where the corners of a face are, and what is drawn there.
struct SeenFace {
  Points corners;
  Eigen::Matrix2Xd texcoords;
  Eigen::Matrix4Xf colours;
  std::string material, object;
  bool operator==(const SeenFace&) const = default;
};

SeenFace face_of(const Mesh& mesh, std::size_t face, const Eigen::Vector3d& moved_by) {
  const std::uint32_t first = mesh.face_starts[face];
  const Eigen::Index count = mesh.face_starts[face + 1] - first;
  SeenFace seen{Points(3, count), Eigen::Matrix2Xd(2, count), Eigen::Matrix4Xf(4, count),
                mesh.look.material_of(face)->name,
                mesh.look.objects.names[mesh.look.objects.of_face[face]]};
  for (Eigen::Index k = 0; k < count; ++k) {
    const auto corner = first + static_cast<std::uint32_t>(k);
    seen.corners.col(k) = mesh.vertices.col(mesh.face_corners[corner]) + moved_by;
    seen.texcoords.col(k) = mesh.texcoords.col(mesh.corner_texcoords[corner]);
    seen.colours.col(k) = mesh.look.vertex_colours.col(mesh.face_corners[corner]);
  }
  return seen;
}

} // namespace

TEST_SUITE("edit_part") {
  TEST_CASE("a copy is beside its part and looks like it, and all else keeps numbers and bits") {
    const Mesh before = two_balls();
    const std::size_t faces = before.face_count() / 2;
    for (const std::uint32_t part : {0U, 1U}) {
      CAPTURE(part);
      const auto made = copied_part(before, part);
      REQUIRE(made);
      CHECK(made->vertices.leftCols(before.vertices.cols()) == before.vertices);
      REQUIRE(made->face_count() == 3 * faces);
      const Eigen::Vector3d aside(1.05 * 2.0, 0.0, 0.0); // the balls are 2 wide
      for (std::size_t face = 0; face < 2 * faces; ++face)
        REQUIRE(face_of(*made, face, {0.0, 0.0, 0.0}) == face_of(before, face, {0.0, 0.0, 0.0}));
      for (std::size_t face = 0; face < faces; ++face) {
        const SeenFace copy = face_of(*made, 2 * faces + face, {0.0, 0.0, 0.0});
        SeenFace expected = face_of(before, part * faces + face, aside);
        REQUIRE((copy.corners - expected.corners).cwiseAbs().maxCoeff() < 1e-14);
        expected.corners = copy.corners;
        REQUIRE(copy == expected);
      }
      CHECK(check_closed_manifold(*made));
      CHECK(separate(*made).size() == 3);
      CHECK(volume_of(*made) == doctest::Approx(1.5 * volume_of(before)));
    }
  }

  TEST_CASE("what is left without a part is the other one, with its bits and its looks") {
    const Mesh before = two_balls();
    const std::size_t faces = before.face_count() / 2;
    for (const std::uint32_t part : {0U, 1U}) {
      CAPTURE(part);
      const auto made = removed_part(before, part);
      REQUIRE(made);
      REQUIRE(made->face_count() == faces);
      CHECK(made->vertices.cols() == before.vertices.cols() / 2);
      for (std::size_t face = 0; face < faces; ++face)
        REQUIRE(face_of(*made, face, {0.0, 0.0, 0.0}) ==
                face_of(before, (1 - part) * faces + face, {0.0, 0.0, 0.0}));
      CHECK(check_closed_manifold(*made));
    }
  }

  TEST_CASE("a copy that is removed leaves what was there before") {
    const Mesh before = two_balls();
    const auto copied = copied_part(before, 0);
    REQUIRE(copied);
    const auto removed = removed_part(*copied, 2);
    REQUIRE(removed);
    CHECK(removed->vertices == before.vertices);
    CHECK(removed->face_corners == before.face_corners);
    CHECK(removed->face_starts == before.face_starts);
    CHECK(removed->look.face_materials == before.look.face_materials);
  }

  TEST_CASE("there is no other part, and nothing is left of a model that is one") {
    const Mesh both = two_balls();
    for (const std::uint32_t part : {2U, 1000U, no_index}) {
      CHECK(copied_part(both, part).error().message == "has no such part");
      CHECK(removed_part(both, part).error().message == "has no such part");
    }
    const auto last = removed_part(test::sphere(9, 16, 1.0), 0);
    REQUIRE_FALSE(last);
    CHECK(last.error().message == "is one part, and nothing would be left of it");
    CHECK(copied_part(Mesh{}, 0).error().message == "has no such part");
  }
}

} // namespace edit_part_test
