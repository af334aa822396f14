#include <doctest/doctest.h>

#include "render/scene.hpp"
#include "support/flow_fixtures.hpp"

namespace scene_test {

using namespace nendo;
using namespace nendo::render;
using nendo::test::LoopUnderTest;

namespace {

// The places that the loop's hands are at, in the scene.
Eigen::Vector3d in_scene(const SceneBuilder& builder, const Eigen::Vector3d& stage) {
  return stage - builder.origin_m();
}

} // namespace

TEST_SUITE("scene") {
  TEST_CASE("the model is on the ground in the middle, and polygons become triangles") {
    auto mesh = test::sphere(7, 9, 2.0); // quads and triangles
    mesh.vertices.colwise() += Eigen::Vector3d(10, 20, 30);
    const SceneBuilder builder(mesh);
    SceneFrame scene_frame;
    scene_frame.vertices = mesh.vertices;
    Scene scene;
    builder.build(scene_frame, {}, scene);
    CHECK(scene.model.corners.size() == 3 * (2 * 9 + 6 * 9 * 2));
    Eigen::Vector3f lowest = scene.model.places[0];
    Eigen::Vector3f highest = lowest;
    for (const auto& place : scene.model.places) {
      lowest = lowest.cwiseMin(place);
      highest = highest.cwiseMax(place);
    }
    CHECK(static_cast<double>(lowest.y()) == doctest::Approx(0.0));
    CHECK(static_cast<double>(lowest.x() + highest.x()) == doctest::Approx(0.0).epsilon(1e-4));
    CHECK(static_cast<double>((highest - lowest).maxCoeff()) ==
          doctest::Approx(0.8)); // as on the loop's stage
    // Outward from its middle, as the faces turn.
    const Eigen::Vector3f middle = (lowest + highest) / 2;
    for (std::size_t at = 0; at < scene.model.places.size(); ++at)
      CHECK(scene.model.normals[at].dot((scene.model.places[at] - middle).normalized()) > 0.9F);
  }

  TEST_CASE(
      "hands are where the loop has them, and arrows go from where they grabbed to the tips") {
    LoopUnderTest test(flow::Mode::type1);
    HoldTracker holds;
    holds.follow(test.frame_after_tick(0));
    const auto taken = test.loop->frames().front().hands[0].pose.fingertip_positions();
    test.bend(25, HostClock::now());
    const flow::Frame& frame = test.frame_after_tick(1);
    holds.follow(frame);
    SceneFrame scene_frame;
    scene_frame.vertices = test.vertices_of(frame);
    set_hands(frame, holds, scene_frame);
    REQUIRE(scene_frame.hands[0]);
    CHECK(scene_frame.hands[0]->starts == taken);
    const auto tips = frame.hands[0].pose.fingertip_positions();
    CHECK((tips - taken).norm() > 0.01);

    const SceneBuilder builder(test.model, frame.units_per_metre);
    Scene scene;
    builder.build(scene_frame, {}, scene);
    CHECK(scene.veils.size() == 2);  // two skins
    CHECK(scene.solids.size() == 2); // the arrows of each
    SceneParts with_bones;
    with_bones.bones = true;
    builder.build(scene_frame, with_bones, scene);
    CHECK(scene.veils.size() == 2);
    CHECK(scene.solids.size() == 4); // bones and arrows of each
    for (Eigen::Index finger = 0; finger < 5; ++finger)
      for (const auto& end :
           {Eigen::Vector3d(taken.col(finger)), Eigen::Vector3d(tips.col(finger))}) {
        double nearest = 1.0;
        for (const auto& place : scene.solids[1].places)
          nearest = std::min(nearest, (place.cast<double>() - in_scene(builder, end)).norm());
        CHECK(nearest < 1e-4);
      }
    SceneParts bare{false, false, false, false, false, false};
    builder.build(scene_frame, bare, scene);
    CHECK(scene.solids.size() + scene.veils.size() + scene.grounds.size() == 0);
  }

  TEST_CASE("a new hold begins with a grab, a commit and an undo, and ends with a release") {
    LoopUnderTest test(flow::Mode::type1);
    HoldTracker holds;
    std::uint64_t tick = 0;
    const auto step = [&](int counts) -> const flow::Frame& {
      test.bend(counts, HostClock::now());
      const flow::Frame& frame = test.frame_after_tick(tick++);
      holds.follow(frame);
      return frame;
    };
    const auto tips = [](const flow::Frame& frame) {
      return TipPlaces(frame.hands[0].pose.fingertip_positions());
    };
    step(0);
    CHECK(holds.starts(0) != tips(step(20)));
    for (const auto request : {flow::Request::commit, flow::Request::undo}) {
      REQUIRE(test.commands.try_push(request));
      CHECK(holds.starts(0) == tips(step(request == flow::Request::commit ? 25 : 5)));
      CHECK(holds.starts(0) != tips(step(12)));
    }
    REQUIRE(test.commands.try_push(flow::Request::release));
    for (int turn = 0; turn < 3; ++turn)
      step(15);
    SceneFrame scene_frame;
    set_hands(test.loop->frames().front(), holds, scene_frame);
    CHECK_FALSE(scene_frame.held);
    CHECK(scene_frame.hands[0]->starts == tips(test.loop->frames().front()));
    REQUIRE(test.commands.try_push(flow::Request::grab));
    const TipPlaces grabbed = tips(step(30));
    CHECK(holds.starts(0) == grabbed);
  }
}

} // namespace scene_test
