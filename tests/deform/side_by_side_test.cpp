// Several models as one.

#include <nendo/deform/edit_part.hpp>

#include <array>
#include <limits>

#include <doctest/doctest.h>

#include <nendo/deform/cut.hpp>

#include "support/test_meshes.hpp"

namespace side_by_side_test {

using namespace nendo;
using namespace nendo::deform;

namespace {

Mesh ball_at(const Eigen::Vector3d& middle, double radius) {
  Mesh ball = test::sphere(9, 16, radius);
  ball.vertices.colwise() += middle;
  return ball;
}

Mesh of_material(Mesh mesh, const char* name, const Eigen::Vector4f& colour) {
  mesh.look.materials = {{name, colour}};
  mesh.look.face_materials.assign(mesh.face_count(), 0);
  return mesh;
}

} // namespace

TEST_SUITE("side_by_side") {
  TEST_CASE("the first keeps its bits, and the others are to its right on the same floor") {
    const std::array models{ball_at({7.0, 1.0, -3.0}, 1.0), ball_at({0.0, -20.0, 9.0}, 2.0),
                            ball_at({100.0, 3.0, 3.0}, 0.5)};
    const auto all = side_by_side(models);
    REQUIRE(all);
    const auto parts = separate(*all);
    REQUIRE(parts.size() == models.size());
    CHECK(parts[0].vertices == models[0].vertices);
    CHECK(all->vertices.leftCols(models[0].vertices.cols()) == models[0].vertices);
    const Box first = finite_box_of(parts[0].vertices);
    double right = first.highest.x();
    for (std::size_t at = 1; at < parts.size(); ++at) {
      CAPTURE(at);
      const Box box = finite_box_of(parts[at].vertices);
      CHECK(box.lowest.x() == doctest::Approx(right + 0.1 * 4.0)); // the widest is 4 wide
      CHECK(box.lowest.y() == doctest::Approx(first.lowest.y()));
      CHECK(box.highest.z() == doctest::Approx(first.highest.z()));
      CHECK(parts[at].face_corners == models[at].face_corners);
      CHECK(volume_of(parts[at]) == doctest::Approx(volume_of(models[at])));
      right = box.highest.x();
    }
  }

  TEST_CASE("materials of one name are one if they are the same, and two if they are not") {
    const Eigen::Vector4f red(1.0F, 0.0F, 0.0F, 1.0F), blue(0.0F, 0.0F, 1.0F, 1.0F);
    const Mesh ball = ball_at({0.0, 0.0, 0.0}, 1.0);
    const std::array models{of_material(ball, "clay", red), of_material(ball, "clay", blue),
                            of_material(ball, "clay", red), ball};
    const auto all = side_by_side(models);
    REQUIRE(all);
    CHECK(all->look.materials.size() == 2);
    const std::size_t faces = ball.face_count();
    CHECK(all->look.material_of(0)->colour == red);
    CHECK(all->look.material_of(faces)->colour == blue);
    CHECK(all->look.material_of(faces)->name == "clay-2");
    CHECK(all->look.material_of(2 * faces) == all->look.material_of(0));
    CHECK(all->look.material_of(3 * faces) == nullptr);
  }

  TEST_CASE("where one has colours and texture coordinates, the others get white and (0, 0)") {
    Mesh seen = ball_at({0.0, 0.0, 0.0}, 1.0);
    seen.texcoords = seen.vertices.topRows<2>();
    seen.corner_texcoords = seen.face_corners;
    seen.look.vertex_colours = Eigen::Matrix4Xf::Constant(4, seen.vertices.cols(), 0.25F);
    const Mesh plain = ball_at({0.0, 0.0, 0.0}, 1.0);
    const auto count = plain.vertices.cols();
    const auto corners = plain.face_corners.size();
    for (const bool is_first : {true, false}) {
      CAPTURE(is_first);
      const auto all =
          is_first ? side_by_side(std::array{seen, plain}) : side_by_side(std::array{plain, seen});
      REQUIRE(all);
      REQUIRE(all->look.vertex_colours.cols() == 2 * count);
      REQUIRE(all->corner_texcoords.size() == 2 * corners);
      const Eigen::Index of_seen = is_first ? 0 : count;
      const Eigen::Index of_plain = count - of_seen;
      CHECK(all->look.vertex_colours.col(of_seen)[0] == 0.25F);
      CHECK(all->look.vertex_colours.col(of_plain)[0] == 1.0F);
      const std::size_t corner = is_first ? 0 : corners;
      CHECK(all->texcoords.col(all->corner_texcoords[corner]) ==
            seen.texcoords.col(seen.corner_texcoords[0]));
      CHECK(all->texcoords.col(all->corner_texcoords[corners - corner]).isZero());
    }
  }

  TEST_CASE("models without vertices, or of numbers that are none, do no harm") {
    const Mesh ball = ball_at({0.0, 0.0, 0.0}, 1.0);
    Mesh strange;
    strange.vertices = Points::Constant(3, 1, std::numeric_limits<double>::quiet_NaN());
    const auto all = side_by_side(std::array{Mesh{}, strange, ball, Mesh{}});
    REQUIRE(all);
    CHECK(all->vertices.rightCols(ball.vertices.cols()) == ball.vertices);
    CHECK(all->face_count() == ball.face_count());
    CHECK(side_by_side({})->face_count() == 0);
  }
}

} // namespace side_by_side_test
