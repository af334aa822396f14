#include <nendo/deform/clay.hpp>

#include <cmath>
#include <memory>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/refinement.hpp>
#include <nendo/deform/triangles.hpp>

#include "reference/icosphere.hpp"
#include "support/contact_parts.hpp"
#include "support/restraint.hpp"
#include "support/self_intersections.hpp"

namespace clay_continue_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using nendo::test::moved;
using Parts = std::vector<ContactPart>;

namespace {

/// Fingers that far out of the middle of the ball.
Parts pinch(double gap, double out) {
  return nendo::test::pinch(gap, {out, 0, 0});
}

/// Clay of a mesh, which may already have a shape.
struct Clay {
  Clay(Mesh model, const BlockShape* first)
      : mesh(std::move(model)), shape(BlockLayout(mesh.vertices), DeformerOptions{}, first),
        clay(shape, corners_of_triangles(mesh), 1, 2, ClayOptions{.radius_mm = 18.0}) {}

  /// The same clay with triangles that follow its shape.
  std::unique_ptr<Clay> refined() const {
    const Refinement made =
        Refiner::make(mesh)->refine(clay.shape(), shape.layout(), RefinementLimits{});
    CHECK(!made.operations.empty());
    const BlockShape first = shape_in_blocks(made.shape, BlockLayout(made.mesh.vertices));
    return std::make_unique<Clay>(made.mesh, &first);
  }
  Mesh now() const {
    Mesh result = mesh;
    shape.layout().unpack(clay.shape(), result.vertices);
    return result;
  }

  Mesh mesh;
  SculptedShape shape;
  ClayDeformer clay;
};

std::unique_ptr<Clay> ball() {
  return std::make_unique<Clay>(nendo::reference::icosphere(4, 30.0), nullptr);
}

/// A ball on which two fingers have closed.
std::unique_ptr<Clay> held_ball() {
  auto clay = ball();
  clay->clay.begin(pinch(60.0, 22.0));
  for (int call = 1; call <= 60; ++call)
    clay->clay.press_to(pinch(60.0 - 44.0 * call / 60.0, 22.0));
  CHECK(clay->clay.report().held > 4);
  return clay;
}

/// Pulls by 15 mm, and returns how far the clay followed.
double pull(Clay& clay) {
  const double before = clay.now().vertices.row(0).maxCoeff();
  for (int call = 1; call <= 60; ++call)
    clay.clay.press_to(pinch(16.0, 22.0 + 0.25 * call));
  return clay.now().vertices.row(0).maxCoeff() - before;
}

} // namespace

TEST_SUITE("clay_continue") {
  TEST_CASE("fingers hold on to clay whose triangles are exchanged") {
    const auto before = held_ball();
    const auto after = before->refined();
    after->clay.begin(pinch(16.0, 22.0));
    {
      const nendo::test::Restraint restraint; // the loop does it in a tick
      after->clay.continue_from(before->clay, true);
      CHECK(restraint.counts().allocations + restraint.counts().frees == 0);
      CHECK(restraint.counts().locks == 0);
    }
    CHECK(pull(*after) > 10.0);
    CHECK(after->clay.report().held == before->clay.report().held);
    CHECK(nendo::test::count_self_intersections(after->now()) == 0);
    // They release as ever.
    for (int call = 1; call <= 30; ++call)
      after->clay.press_to(pinch(16.0 + call, 37.0));
    CHECK(after->clay.report().held == 0);
  }

  TEST_CASE("the same triangles give the same shape as without an exchange") {
    const auto straight = held_ball();
    const auto before = held_ball();
    Clay after(before->mesh, &before->clay.shape());
    after.clay.begin(pinch(16.0, 22.0));
    after.clay.continue_from(before->clay, true);
    pull(*straight);
    pull(after);
    // What vertices remember of the pressure, for friction, is gone.
    CHECK((straight->now().vertices - after.now().vertices).colwise().norm().maxCoeff() < 0.5);
  }

  TEST_CASE("a way on which the bodies were during the exchange is still made") {
    const auto before = ball();
    before->clay.begin(pinch(60.0, 22.0));
    before->clay.press_to(pinch(55.0, 22.0));
    Clay after(before->mesh, &before->clay.shape());
    after.clay.begin(pinch(16.0, 22.0)); // as if they had jumped into the clay
    after.clay.continue_from(before->clay, true);
    after.clay.press_to(pinch(16.0, 22.0));
    CHECK(after.clay.report().sub_steps > 4);
    CHECK(after.clay.report().penetration_mm <= 0.02);
  }

  TEST_CASE("volume that is owed is given back after the exchange") {
    const auto before = ball();
    const double whole = volume_of(before->mesh);
    before->clay.begin(pinch(80.0, 0.0));
    before->clay.press_to(pinch(4.0, 0.0)); // at once: more than one call can give back
    REQUIRE(std::abs(volume_of(before->now()) / whole - 1.0) > 3e-4);
    Clay after(before->mesh, &before->clay.shape());
    after.clay.begin(pinch(4.0, 0.0));
    after.clay.continue_from(before->clay, true);
    for (int call = 0; call < 60; ++call)
      after.clay.press_to(pinch(4.0, 0.0));
    CHECK(std::abs(volume_of(after.now()) / whole - 1.0) < 2e-5);
  }

  TEST_CASE("another number of bodies takes nothing over") {
    const auto before = held_ball();
    SculptedShape shape(BlockLayout(before->mesh.vertices), DeformerOptions{},
                        &before->clay.shape());
    ClayDeformer two(shape, corners_of_triangles(before->mesh), 2, 2, ClayOptions{});
    Parts parts = pinch(16.0, 22.0);
    const Parts others = moved(pinch(16.0, 22.0), Vector3d(0.0, 200.0, 0.0));
    parts.insert(parts.end(), others.begin(), others.end());
    two.begin(parts);
    two.continue_from(before->clay, true);
    CHECK(two.press_to(parts).held == 0);
    CHECK(two.report().remaining_path_mm == 0.0);
  }
}

} // namespace clay_continue_test
