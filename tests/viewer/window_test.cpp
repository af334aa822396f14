// The live window, on a screen that exists in memory alone.

#include <cstdlib>

#include <Eigen/Geometry>
#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include "render/picture.hpp"
#include "support/eventually.hpp"
#include "support/flow_fixtures.hpp"
#include "support/memory_screen.hpp"
#include "support/open_window.hpp"
#include "support/restraint.hpp"
#include "viewer/live_window.hpp"
#include "viewer/puppet_editor.hpp"

namespace window_test {

using namespace nendo;
using namespace nendo::render;
using namespace nendo::viewer;

namespace {

double intersection_over_union(const Image& a, const Image& b) {
  double both = 0.0;
  double either = 0.0;
  for (std::size_t at = 0; at < a.pixels().size(); ++at) {
    const bool in_a = a.pixels()[at][0] > 127;
    const bool in_b = b.pixels()[at][0] > 127;
    both += in_a && in_b ? 1.0 : 0.0;
    either += in_a || in_b ? 1.0 : 0.0;
  }
  return either > 0.0 ? both / either : 0.0;
}

} // namespace

TEST_SUITE("window") {
  TEST_CASE("OpenGL draws what the processor draws, and sends only blocks that changed") {
    if (!test::restraint_is_counted) return; // Mesa's own memory is not for our sanitizers
    const test::MemoryScreen screen;
    if (!screen.is_there()) {
      MESSAGE("no Xvfb here, so the window is not tested; tools/setup check installs it");
      return;
    }
    test::LoopUnderTest test(flow::Mode::type1);
    constexpr Size size{400, 300};
    LiveWindow window(test::open_window({size, Theme::light, 1.0F}));
    const SceneBuilder builder(test.model, test.placement.units_per_metre);
    window.begin(test.loop->changes().layout(), builder, {});
    const auto blocks = test.loop->changes().layout().block_count();

    HoldTracker holds;
    for (std::uint64_t tick = 0; tick < 4; ++tick) {
      test.bend(static_cast<int>(8 * tick), HostClock::now());
      const flow::Frame& frame = test.frame_after_tick(tick);
      const auto before = window.scene_window().blocks_sent();
      CHECK(window.show(frame, true, {}).empty());
      if (tick == 0) CHECK(window.scene_window().blocks_sent() - before == blocks);
      const auto sent = window.scene_window().blocks_sent();
      window.show(frame, true, {}); // the same frame again: nothing has changed
      CHECK(window.scene_window().blocks_sent() == sent);

      holds.follow(frame);
      SceneFrame scene_frame;
      set_hands(frame, holds, scene_frame);
      test.loop->changes().layout().unpack(frame.shape, scene_frame.vertices);
      Scene scene;
      builder.build(scene_frame, {}, scene);
      const Image by_processor = silhouette(scene, window.scene_window().camera(), size);
      CHECK(intersection_over_union(by_processor, window.scene_window().silhouette(size)) > 0.97);
    }
    const PictureTimes& times = window.picture_times(); // of those that are said to be new
    CHECK(times.whole.count() == 8);
    CHECK(times.preparing.count() == 8);
    CHECK(times.preparing.max() < times.whole.max());
    // And not the same whatever is drawn: the model before it was shaped, seen from elsewhere.
    Camera other = window.scene_window().camera();
    other.orbit(200.0, 0.0);
    Scene scene = window.scene_window().scene();
    SceneFrame scene_frame;
    scene_frame.vertices = 0.7 * test.model.vertices;
    builder.build(scene_frame, {}, scene);
    CHECK(intersection_over_union(silhouette(scene, other, size),
                                  window.scene_window().silhouette(size)) < 0.9);
    const Image shown = window.scene_window().screenshot();
    CHECK(shown.size() == size);
    CHECK_FALSE(shown == Image(size, shown.at(0, 0)));
  }

  TEST_CASE("there is a key for all that the panel has, and what is chosen is asked for at once") {
    if (!test::restraint_is_counted) return; // Mesa's own memory is not for our sanitizers
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    test::LoopUnderTest test(flow::Mode::type1);
    LiveWindow window(test::open_window({{400, 300}, Theme::light, 1.0F}));
    flow::LoopSettings settings;
    settings.radius_m.fill(0.1);
    window.begin(test.loop->changes().layout(),
                 SceneBuilder(test.model, test.placement.units_per_metre), settings);
    flow::Frame frame = test.frame_after_tick(0);
    frame.undo_steps = frame.redo_steps = 1;
    frame.settings = settings;
    Gauges gauges;
    const auto type = [&](int key) {
      SimulatedInput input;
      input.taps = {key};
      window.scene_window().simulate(input);
      auto commands = window.show(frame, false, gauges);
      window.scene_window().simulate({});
      window.show(frame, false, {});
      return commands;
    };
    using flow::Request;
    for (const auto& [key, request] : {std::pair{GLFW_KEY_G, Request::grab},
                                       {GLFW_KEY_L, Request::release},
                                       {GLFW_KEY_C, Request::commit},
                                       {GLFW_KEY_U, Request::undo},
                                       {GLFW_KEY_R, Request::redo},
                                       {GLFW_KEY_X, Request::reset}})
      CHECK(type(key) == Commands{request});
    CHECK(type(GLFW_KEY_T) == Commands{flow::SetRecording{true}});
    CHECK(type(GLFW_KEY_S) == Commands{flow::SaveShape{}});
    CHECK(type(GLFW_KEY_K).empty()); // nothing is kept
    gauges.facts.keeps_last = true;
    CHECK(type(GLFW_KEY_K) == Commands{flow::SaveRecording{}});
    CHECK(type(GLFW_KEY_Q) == Commands{flow::EndRun{}});

    settings.mode = flow::Mode::type2;
    CHECK(type(GLFW_KEY_M) == Commands{flow::ChangeSettings{settings}});
    settings.kernel = deform::Wendland::c4;
    CHECK(type(GLFW_KEY_N) == Commands{flow::ChangeSettings{settings}});
    settings.injective = true;
    CHECK(type(GLFW_KEY_I) == Commands{flow::ChangeSettings{settings}});
    settings.radius_m.fill(1.1 * 0.1);
    CHECK(type(GLFW_KEY_RIGHT_BRACKET) == Commands{flow::ChangeSettings{settings}});
    CHECK(window.show(frame, false, {}).empty()); // once is enough
    // The request of another client is shown, and the next key continues from there.
    settings.mode = flow::Mode::type1;
    settings.radius_m = {0.1, 0.2, 0.3, 0.3, 0.2};
    frame.settings = settings;
    test::eventually([&] {
      CHECK(window.show(frame, false, {}).empty());
      return window.settings() == settings;
    });
    settings.kernel = deform::Wendland::c6;
    CHECK(type(GLFW_KEY_N) == Commands{flow::ChangeSettings{settings}});

    const auto drawn_after = [&](int key) {
      type(key);
      window.show(frame, false, {});
      std::size_t places = 0;
      for (const Surface& solid : window.scene_window().scene().solids)
        places += solid.places.size();
      return places;
    };
    const std::size_t with_bones = drawn_after(GLFW_KEY_B);
    const std::size_t without_bones = drawn_after(GLFW_KEY_B);
    CHECK(with_bones > without_bones);
  }

  TEST_CASE("the mouse takes the hand that is seen under it, wherever the model's origin is") {
    if (!test::restraint_is_counted) return; // Mesa's own memory is not for our sanitizers
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    test::LoopUnderTest test(flow::Mode::type1);
    constexpr Size size{800, 600};
    LiveWindow window(test::open_window({size, Theme::light, 1.0F}));
    const SceneBuilder builder(test.model, test.placement.units_per_metre);
    REQUIRE(builder.origin_m().norm() > 0.1);
    window.begin(test.loop->changes().layout(), builder, {});
    const flow::Frame& frame = test.frame_after_tick(0);
    window.show(frame, true, {});
    SimulatedInput input;
    const Size scene = window.scene_window().scene_size(); // above the status bar
    for (const auto& joint : frame.hands[1].pose.joints) { // the one that the panel covers least
      const Eigen::Vector4d clip =
          window.scene_window().camera().projection(1.0 * scene.width / scene.height) *
          (joint.translation() - builder.origin_m()).homogeneous();
      const Eigen::Vector2d pixel((1.0 + clip.x() / clip.w()) / 2 * scene.width,
                                  (1.0 - clip.y() / clip.w()) / 2 * scene.height);
      if (pixel.x() > input.pointer.x()) input.pointer = pixel;
    }
    window.scene_window().simulate(input);
    window.show(frame, false, {});
    input.buttons[1] = true;
    window.scene_window().simulate(input);
    window.show(frame, false, {});
    input.pointer.y() -= 10.0;
    window.scene_window().simulate(input);
    const Commands commands = window.show(frame, false, {});
    REQUIRE(commands.size() == 1);
    const auto* moved = std::get_if<flow::WristMove>(&commands.front());
    REQUIRE(moved != nullptr);
    CHECK(moved->side == Side::right);
    CHECK(moved->pose().translation().y() > frame.hands[1].T_stage_wrist.translation().y());
  }

  TEST_CASE("a mark that waits for its finger is held, and neither it nor the camera moves") {
    if (!test::restraint_is_counted) return; // Mesa's own memory is not for our sanitizers
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    test::LoopUnderTest test(flow::Mode::type1);
    constexpr Size size{800, 600};
    LiveWindow window(test::open_window({size, Theme::light, 1.0F}));
    const SceneBuilder builder(test.model, test.placement.units_per_metre);
    window.begin(test.loop->changes().layout(), builder, {});
    PuppetEditor& editor = window.editor();
    editor.begin(test.model, "ball.obj", nullptr);
    editor.turn(true);
    const flow::Frame& frame = test.frame_after_tick(0);
    window.show(frame, true, {});
    SimulatedInput input;
    const auto move = [&](const Eigen::Vector2d& pointer, bool left) {
      input.pointer = pointer;
      input.buttons[0] = left;
      window.scene_window().simulate(input);
      window.show(frame, false, {});
    };
    const auto drag = [&](const Eigen::Vector2d& from) {
      move(from, false);
      move(from, true);
      for (int step = 1; step <= 5; ++step)
        move(from + Eigen::Vector2d(3.0 * step, -20.0 * step), true);
      move(input.pointer, false);
    };
    const Eigen::Vector3d middle_m = 0.5 * builder.size_m().y() * Eigen::Vector3d::UnitY();
    const Eigen::Vector4d clip =
        window.scene_window().camera().projection(1.0 * size.width / size.height) *
        middle_m.homogeneous();
    const Eigen::Vector2d mark((1.0 + clip.x() / clip.w()) / 2 * size.width,
                               (1.0 - clip.y() / clip.w()) / 2 * size.height);
    move(mark, false);
    move(mark, true);
    move(mark, false);
    REQUIRE(editor.pending());
    const Eigen::Vector3d place = editor.pending()->at;
    const Camera before = window.scene_window().camera();
    drag(mark);
    REQUIRE(editor.pending());
    CHECK(editor.pending()->at == place);
    CHECK(editor.message().starts_with("Bend the finger"));
    CHECK(window.scene_window().camera().view.azimuth_deg == before.view.azimuth_deg);
    CHECK(window.scene_window().camera().view.elevation_deg == before.view.elevation_deg);
    CHECK(window.scene_window().camera().eye() == before.eye());
    drag({780.0, 500.0}); // the control: beside the model, the same way turns the camera
    CHECK(window.scene_window().camera().view.elevation_deg != before.view.elevation_deg);
  }
}

} // namespace window_test
