// The live window's panel and its keys, with a mouse and a keyboard that the test simulates.

#include <algorithm>

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"
#include "support/memory_screen.hpp"
#include "support/restraint.hpp"
#include "viewer/live_window.hpp"

namespace window_panel_test {

using namespace nendo;
using namespace nendo::render;
using namespace nendo::viewer;
using Eigen::Vector3d;
using flow::Request;

namespace {

constexpr Size size{800, 760};
constexpr int panel_right = 260; // pixels from the window's left

/// A person before the window.
struct Person {
  test::LoopUnderTest test{flow::Mode::type1};
  SceneBuilder builder{test.model, test.placement.units_per_metre};
  std::unique_ptr<LiveWindow> window;
  flow::Frame frame;
  Gauges gauges;

  Person() : frame(test.frame_after_tick(0)) {
    auto opened = LiveWindow::open("test", size);
    REQUIRE_MESSAGE(opened, (opened ? "" : opened.error().message));
    window = *std::move(opened);
    flow::LoopSettings settings;
    settings.radius_m.fill(0.1);
    window->begin(test.loop->changes().layout(), builder, settings);
    window->show(frame, true, gauges);
    window->show(frame, false, gauges);
  }
  Commands give(const SimulatedInput& input) {
    window->scene_window().simulate(input);
    Commands commands = window->show(frame, false, gauges);
    window->scene_window().simulate({});
    const Commands more = window->show(frame, false, gauges);
    commands.insert(commands.end(), more.begin(), more.end());
    return commands;
  }
  Commands type(int key, bool control = false, bool shift = false) {
    SimulatedInput input;
    input.taps = {key};
    input.control = control;
    input.shift = shift;
    return give(input);
  }
  Commands click(double x, double y) {
    SimulatedInput input;
    input.pointer = {x, y};
    window->scene_window().simulate(input); // a button is pressed where the pointer was before
    window->show(frame, false, gauges);
    input.buttons[0] = true;
    window->scene_window().simulate(input);
    Commands commands = window->show(frame, false, gauges);
    input.buttons[0] = false;
    window->scene_window().simulate(input);
    const Commands more = window->show(frame, false, gauges);
    commands.insert(commands.end(), more.begin(), more.end());
    return commands;
  }
  /// All that the panel's upper buttons ask for, in their order.
  Commands click_all() {
    Commands all;
    for (double y = 60.0; y < 150.0; y += 14.0)
      for (const double x : {70.0, 190.0})
        for (const flow::Command& command : click(x, y))
          if (std::find(all.begin(), all.end(), command) == all.end()) all.push_back(command);
    return all;
  }
};

bool has(const Commands& commands, const flow::Command& command) {
  return std::find(commands.begin(), commands.end(), command) != commands.end();
}

} // namespace

TEST_SUITE("window_panel" * doctest::skip(!test::restraint_is_counted)) {
  TEST_CASE("a click on a step of the history goes there: as many undos or redos as are between") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    flow::StepList& list = person.frame.steps;
    list.steps[0] = {flow::StepKind::stroke, 1.0F};
    list.steps[1] = {flow::StepKind::radius, 2.0F};
    list.steps[2] = {flow::StepKind::stroke, 65.0F};
    list.count = 3;
    list.undoable = 1;
    for (const bool in_hand : {false, true}) {
      list.in_hand = in_hand;
      person.frame.undo_steps = in_hand ? 2 : 1;
      person.frame.redo_steps = 2;
      std::vector<std::size_t> undos, redos;        // that single clicks asked for
      for (double y = 654.0; y < 744.0; y += 6.0) { // of the list
        const Commands asked = person.click(110.0, y);
        if (asked.empty()) continue;
        const auto count = [&](Request request) {
          return static_cast<std::size_t>(
              std::count(asked.begin(), asked.end(), flow::Command(request)));
        };
        if (count(Request::undo) == asked.size()) undos.push_back(asked.size());
        if (count(Request::redo) == asked.size()) redos.push_back(asked.size());
      }
      const auto has_asked = [](const std::vector<std::size_t>& counts, std::size_t wanted) {
        return std::find(counts.begin(), counts.end(), wanted) != counts.end();
      };
      CHECK(has_asked(undos, in_hand ? 2 : 1)); // to the beginning
      CHECK(has_asked(redos, 1));
      CHECK(has_asked(redos, 2));
    }
  }

  TEST_CASE("where there is nothing to undo or redo, their buttons are grey, and keys say so") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    person.gauges.report = "saved as head-1.obj";
    REQUIRE(person.frame.undo_steps == 0);
    const Commands without = person.click_all();
    CHECK(has(without, Request::grab));
    CHECK(has(without, Request::release));
    CHECK(has(without, Request::commit));
    CHECK_FALSE(has(without, Request::undo));
    CHECK_FALSE(has(without, Request::redo));
    CHECK(person.window->message() == person.gauges.report);
    for (const int key : {GLFW_KEY_U, GLFW_KEY_Z}) {
      CHECK(person.type(key, key == GLFW_KEY_Z) ==
            Commands{Request::undo}); // the loop may be ahead
      CHECK(person.window->message() == "There is nothing to undo.");
    }
    CHECK(person.type(GLFW_KEY_G) == Commands{Request::grab});
    CHECK(person.window->message() == person.gauges.report);
    for (const auto& [key, shift] :
         {std::pair{GLFW_KEY_R, false}, {GLFW_KEY_Y, false}, {GLFW_KEY_Z, true}}) {
      CHECK(person.type(key, key != GLFW_KEY_R, shift) == Commands{Request::redo});
      CHECK(person.window->message() == "There is nothing to redo.");
      person.type(GLFW_KEY_G);
    }

    person.frame.undo_steps = 2;
    person.frame.redo_steps = 1;
    // The page's order, two in a line.
    const Commands order = person.click_all();
    CHECK(order == Commands{Request::grab, Request::release, Request::undo, Request::redo,
                            Request::commit, Request::reset});
    CHECK(person.type(GLFW_KEY_U) == Commands{Request::undo});
    CHECK(person.type(GLFW_KEY_Z, true) == Commands{Request::undo});
    CHECK(person.type(GLFW_KEY_R) == Commands{Request::redo});
    CHECK(person.type(GLFW_KEY_Z, true, true) == Commands{Request::redo});
    CHECK(person.type(GLFW_KEY_Y, true) == Commands{Request::redo});
  }

  TEST_CASE("keys look from the sides that they have in Blender") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    const double distance_m = person.window->scene_window().camera().distance_m;
    struct Expected {
      int key;
      bool control;
      Vector3d eye; // from what is looked at
    };
    for (const Expected& expected : {Expected{GLFW_KEY_1, false, Vector3d::UnitZ()},
                                     Expected{GLFW_KEY_KP_3, false, Vector3d::UnitX()},
                                     Expected{GLFW_KEY_7, false, Vector3d::UnitY()},
                                     Expected{GLFW_KEY_1, true, -Vector3d::UnitZ()},
                                     Expected{GLFW_KEY_3, true, -Vector3d::UnitX()},
                                     Expected{GLFW_KEY_KP_7, true, -Vector3d::UnitY()}}) {
      CHECK(person.type(expected.key, expected.control).empty());
      const Camera& camera = person.window->scene_window().camera();
      const Vector3d eye = (camera.eye() - camera.target) / distance_m;
      CHECK((eye - expected.eye).norm() < 1e-9);
    }
  }

  TEST_CASE("Home has all in the part of the window that the panel leaves free, as at first") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    const auto columns = [&] { // the first and the last that show something
      const Image image = person.window->scene_window().silhouette(size);
      std::pair<int, int> range{size.width, -1};
      for (int x = 0; x < size.width; ++x)
        for (int y = 0; y < size.height; ++y)
          if (image.at(x, y)[0] > 127) range = {std::min(range.first, x), x};
      return range;
    };
    const auto is_framed = [&](int covered) {
      const auto [first, last] = columns();
      CHECK(first >= covered);
      CHECK(last < size.width);
      CHECK(std::abs((first + last) / 2.0 - (covered + size.width) / 2.0) < 25.0);
    };
    is_framed(panel_right);
    SimulatedInput drag; // away
    drag.pointer = {500.0, 300.0};
    drag.shift = true;
    person.window->scene_window().simulate(drag);
    person.window->show(person.frame, false, {});
    drag.buttons[0] = true;
    person.window->scene_window().simulate(drag);
    person.window->show(person.frame, false, {});
    drag.pointer.x() -= 300.0;
    drag.wheel = 4.0;
    person.give(drag);
    CHECK(columns().first < panel_right);
    const View view = person.window->scene_window().camera().view;
    person.type(GLFW_KEY_HOME);
    is_framed(panel_right);
    CHECK(person.window->scene_window().camera().view.azimuth_deg == view.azimuth_deg);
    CHECK(person.window->scene_window().camera().view.elevation_deg == view.elevation_deg);

    person.type(GLFW_KEY_P); // folded, the panel covers nothing
    person.type(GLFW_KEY_HOME);
    is_framed(0);
    person.type(GLFW_KEY_P);
    person.type(GLFW_KEY_HOME);
    is_framed(panel_right);
  }

  TEST_CASE("whatever the panel says is in the panel, a warning before a change, too") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    const Image before = person.window->scene_window().screenshot();
    person.type(GLFW_KEY_M);
    person.gauges.report = "saved as /a/very/long/path/that/is/longer/than/the/panel/is/wide.obj";
    person.type(GLFW_KEY_G);
    const Image after = person.window->scene_window().screenshot();
    bool beside_changed = false;
    int changed = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        if (before.at(x, y) == after.at(x, y)) continue;
        ++changed;
        beside_changed = beside_changed || x > panel_right;
      }
    CHECK(changed > 1000);
    CHECK_FALSE(beside_changed);
    // No letter touches the frame: a margin at the panel's right stays as empty as it is.
    int written = 0;
    for (int y = 40; y < size.height - 20; ++y)
      for (int x = panel_right - 9; x < panel_right - 1; ++x)
        if (after.at(x, y)[0] < 110 && after.at(x, y)[1] < 110) ++written;
    CHECK(written == 0);
  }
}

} // namespace window_panel_test
