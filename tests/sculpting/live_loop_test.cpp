#include <nendo/sculpting/live_loop.hpp>

#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>

#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"

namespace live_loop_test {

using namespace nendo;
using sculpting::LiveLoop;
using sculpting::LiveOptions;

namespace {

LiveOptions simulated() {
  LiveOptions options;
  options.left = "sim:grasp";
  options.right = "sim:sculpt";
  return options;
}

/// Takes frames until one of them is as it should be, or 20 s have passed.
template <class Condition>
bool comes(LiveLoop& live, Condition&& condition) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(20);
  while (std::chrono::steady_clock::now() < end) {
    if (live.update() && condition(live.frame())) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  return false;
}

double farthest_move(LiveLoop& live) {
  return (live.vertices() - live.model().vertices).colwise().norm().maxCoeff();
}

} // namespace

TEST_SUITE("live_loop") {
  TEST_CASE("both hands shape a model of a file, and finish() returns it") {
    const test::TemporaryFolder folder;
    const auto path = folder.path() / "ball.obj";
    REQUIRE(deform::write_mesh(path, test::sphere(12, 24, 1.0)));
    auto live = LiveLoop::begin(path.string(), simulated());
    REQUIRE(live);
    CHECK(live->hands().size() == 2);
    CHECK(live->vertices() == live->model().vertices); // before the first frame
    REQUIRE(comes(*live, [](const flow::Frame& frame) { return frame.ticks_run > 60; }));
    CHECK(live->frame().hands[0].present);
    CHECK(live->frame().hands[1].present);
    CHECK(farthest_move(*live) > 0.0);
    CHECK_FALSE(live->has_ended()); // a simulated hand never ends
    LiveLoop moved = *std::move(live);
    const deform::Mesh shape = moved.finish();
    CHECK(shape.face_corners == moved.model().face_corners);
    CHECK(shape.vertices != moved.model().vertices);
    CHECK(moved.stats().ticks > 60);
  }

  TEST_CASE("one hand alone shapes, in metres of the stage") {
    LiveOptions options;
    options.right = "sim";
    options.radius_m = 0.16;
    options.model_size_m = 0.8;
    auto live = LiveLoop::begin(test::sphere(12, 24, 1.0), options);
    REQUIRE(live);
    CHECK(live->hands().size() == 1);
    REQUIRE(comes(*live, [](const flow::Frame&) { return true; }));
    CHECK_FALSE(live->frame().hands[0].present);
    CHECK(live->frame().units_per_metre == doctest::Approx(2.0 / 0.8));
    CHECK(live->settings().radius_m[0] == doctest::Approx(0.16));
    CHECK(live->settings().filter == flow::usual_settings().filter);
  }

  TEST_CASE("the loop does what it is asked for, and an undo of settings leads back") {
    auto live = LiveLoop::begin(test::sphere(12, 24, 1.0), simulated());
    REQUIRE(live);
    REQUIRE(comes(*live, [](const flow::Frame& frame) { return frame.held; }));
    REQUIRE(live->ask(flow::Request::release));
    CHECK(comes(*live, [](const flow::Frame& frame) { return !frame.held; }));
    flow::LoopSettings wanted = live->settings();
    REQUIRE(wanted.mode == flow::Mode::type1);
    wanted.mode = flow::Mode::type2;
    REQUIRE(live->ask(flow::ChangeSettings{wanted}));
    const auto has_mode = [](flow::Mode mode) {
      return [mode](const flow::Frame& frame) { return frame.settings.mode == mode; };
    };
    CHECK(comes(*live, has_mode(flow::Mode::type2)));
    REQUIRE(live->ask(flow::Request::undo));
    CHECK(comes(*live, has_mode(flow::Mode::type1)));
  }

  TEST_CASE("errors say which argument is wrong, and nothing is left running") {
    const auto code_of = [](const auto& result) { return result ? Errc{} : result.error().code; };
    const deform::Mesh ball = test::sphere(12, 24, 1.0);
    LiveOptions options;
    options.right = "abacus:1";
    CHECK(code_of(LiveLoop::begin(ball, options)) == Errc::usage);
    options.right = "sim";
    options.radius_m = 0.0;
    CHECK(code_of(LiveLoop::begin(ball, options)) == Errc::usage);
    options.radius_m.reset();
    options.model_size_m = 20.0;
    const auto large = LiveLoop::begin(ball, options);
    REQUIRE_FALSE(large);
    CHECK(large.error().message == "model_size_m: use 0.01 to 10 m");
    options.model_size_m.reset();
    options.pace.rate_hz = 0.0;
    CHECK(code_of(LiveLoop::begin(ball, options)) == Errc::usage);
    options.pace.rate_hz = 90.0;
    CHECK(code_of(LiveLoop::begin("/nowhere/bust.obj", options)) == Errc::bad_input);
    auto live = LiveLoop::begin(ball, options);
    REQUIRE(live);
    CHECK(code_of(live->ask(flow::SaveShape{})) == Errc::usage);
    flow::LoopSettings bad = live->settings();
    bad.radius_m[0] = -1.0;
    CHECK(code_of(live->ask(flow::ChangeSettings{bad})) == Errc::bad_input);
  }
}

} // namespace live_loop_test
