// The live window's panel and its keys, with a mouse and a keyboard that the test simulates.

#include <algorithm>

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include "support/control_laws.hpp"
#include "support/flow_fixtures.hpp"
#include "support/memory_screen.hpp"
#include "support/open_window.hpp"
#include "support/restraint.hpp"
#include "viewer/controls.hpp"
#include "viewer/live_window.hpp"
#include "viewer/pointing.hpp"
#include "viewer/puppet_editor.hpp"

namespace window_panel_test {

using namespace nendo;
using namespace nendo::render;
using namespace nendo::viewer;
using Eigen::Vector3d;
using flow::Request;

namespace {

constexpr Size size{800, 760};

/// Where the panel ends, in pixels from the window's left.
int panel_right() {
  float right = 0.0F;
  for (const Control& control : controls())
    if (control.name == "Tool") right = control.max.x();
  return static_cast<int>(right) + 12; // the panel's padding
}

const Control* control_named(const std::string& name) {
  for (const Control& control : controls())
    if (control.name == name) return &control;
  return nullptr;
}

/// A person before the window.
struct Person {
  test::LoopUnderTest test{flow::Mode::type1};
  SceneBuilder builder{test.model, test.placement.units_per_metre};
  std::unique_ptr<LiveWindow> window;
  flow::Frame frame;
  Gauges gauges;

  explicit Person(WindowLook look = {size, Theme::light, 1.0F}) : frame(test.frame_after_tick(0)) {
    window = std::make_unique<LiveWindow>(test::open_window(look));
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
  /// Shows one picture with this input, which stays.
  Commands hold(SimulatedInput& input) {
    window->scene_window().simulate(input);
    Commands commands = window->show(frame, false, gauges);
    input.taps.clear();
    input.text.clear();
    window->scene_window().simulate(input);
    const Commands more = window->show(frame, false, gauges);
    commands.insert(commands.end(), more.begin(), more.end());
    return commands;
  }
  void set(const flow::LoopSettings& settings) {
    frame.settings = settings;
    window->show(frame, true, gauges);
    window->show(frame, false, gauges);
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
  /// Clicks the control of this name, which must be there.
  Commands press(const std::string& name) {
    const Control* const control = control_named(name);
    REQUIRE_MESSAGE(control != nullptr, name);
    const Eigen::Vector2f middle = (control->min + control->max) / 2.0F;
    return click(static_cast<double>(middle.x()), static_cast<double>(middle.y()));
  }
};

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
      person.give({});
      const Commands all_undos(in_hand ? 2 : 1, Request::undo);
      CHECK(person.press("step 0") == all_undos); // to the beginning
      CHECK(person.press("step 2") == Commands(1, Request::redo));
      CHECK(person.press("step 3") == Commands(2, Request::redo));
    }
  }

  TEST_CASE("where there is nothing to undo or redo, their buttons are grey, and keys say so") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    person.gauges.report = "saved as head-1.obj";
    REQUIRE(person.frame.undo_steps == 0);
    CHECK(person.press("Grab") == Commands{Request::grab});
    CHECK(person.press("Release") == Commands{Request::release});
    CHECK(person.press("Commit") == Commands{Request::commit});
    for (const std::string grey : {"Undo", "Redo"}) {
      CHECK(person.press(grey).empty());
      CHECK_FALSE(control_named(grey)->is_possible);
    }
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
    person.window->show(person.frame, true, person.gauges);
    CHECK(person.press("Undo") == Commands{Request::undo});
    CHECK(person.press("Redo") == Commands{Request::redo});
    CHECK(person.press("Reset") == Commands{Request::reset});
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
      const Image image =
          person.window->scene_window().silhouette(person.window->scene_window().scene_size());
      std::pair<int, int> range{size.width, -1};
      for (int x = 0; x < size.width; ++x)
        for (int y = 0; y < image.size().height; ++y)
          if (image.at(x, y)[0] > 127) range = {std::min(range.first, x), x};
      return range;
    };
    const auto is_framed = [&](int covered) {
      const auto [first, last] = columns();
      CHECK(first >= covered);
      CHECK(last < size.width);
      CHECK(std::abs((first + last) / 2.0 - (covered + size.width) / 2.0) < 25.0);
    };
    is_framed(panel_right());
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
    CHECK(columns().first < panel_right());
    const View view = person.window->scene_window().camera().view;
    person.type(GLFW_KEY_HOME);
    is_framed(panel_right());
    CHECK(person.window->scene_window().camera().view.azimuth_deg == view.azimuth_deg);
    CHECK(person.window->scene_window().camera().view.elevation_deg == view.elevation_deg);

    person.type(GLFW_KEY_P); // folded, the panel covers nothing
    person.type(GLFW_KEY_HOME);
    is_framed(0);
    person.type(GLFW_KEY_P);
    person.type(GLFW_KEY_HOME);
    is_framed(panel_right());
  }

  TEST_CASE("what the window says is in the bar at its bottom, and moves nothing") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    const Image before = person.window->scene_window().screenshot();
    person.gauges.report = "saved as /a/very/long/path/that/is/longer/than/the/panel/is/wide.obj";
    person.type(GLFW_KEY_G);
    REQUIRE(control_named("message") != nullptr);
    const auto bar = static_cast<int>(control_named("message")->min.y()) - 10;
    const Image after = person.window->scene_window().screenshot();
    int above = 0, inside = 0;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x)
        if (!(before.at(x, y) == after.at(x, y))) ++(y < bar ? above : inside);
    CHECK(above == 0);
    CHECK(inside > 500);
  }

  TEST_CASE("figures stay beside what the window says, and only errors have a warning's colour") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    const auto names = [&] {
      std::vector<std::string> all;
      for (const Control& control : controls())
        if (control.name.starts_with("status ")) all.push_back(control.name);
      return all;
    };
    const auto say = [&](const std::string& words, bool is_error = false) {
      person.gauges.report = words;
      person.gauges.report_is_error = is_error;
      person.window->show(person.frame, true, person.gauges);
    };
    /// Pixels of the message that are redder than they are blue.
    const auto red = [&] {
      const Image shown = person.window->scene_window().screenshot();
      const Control& message = *control_named("message");
      int count = 0;
      for (int y = static_cast<int>(message.min.y()); y < static_cast<int>(message.max.y()); ++y)
        for (int x = static_cast<int>(message.min.x()); x < static_cast<int>(message.max.x()); ++x)
          count += shown.at(x, y)[0] > shown.at(x, y)[2] + 60 ? 1 : 0;
      return count;
    };
    say("");
    const auto all = names();
    REQUIRE(all.size() >= 3);
    say("saved as head-1.obj");
    CHECK(names() == all);
    CHECK(red() == 0);
    say("head-1.obj: no space", true);
    CHECK(names() == all);
    CHECK(red() > 20);
    for (std::size_t length = 0; length < 400; length += 7) {
      say("saved as /" + std::string(length, 'x') + "/head.obj");
      test::check_controls();
      const auto shown = names();
      CHECK(std::equal(shown.begin(), shown.end(), all.begin()));
      CHECK(control_named("message")->min.x() >= 0.0F);
    }
    CHECK(names().empty());
  }

  TEST_CASE("no two controls overlap and no text is cut, in any mode, at any size and scale") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    struct Case {
      Size size;
      float scale;
    };
    for (const Case& one : {Case{{1280, 720}, 1.0F}, Case{{1920, 1080}, 1.0F},
                            Case{{1920, 1080}, 2.0F}, Case{{3840, 2160}, 2.0F}}) {
      Person person({one.size, Theme::dark, one.scale});
      for (const flow::Mode mode :
           {flow::Mode::type1, flow::Mode::type2, flow::Mode::clay, flow::Mode::parts}) {
        person.frame.settings = {};
        person.frame.settings.mode = mode;
        person.frame.settings.radius_m.fill(0.1);
        person.window->show(person.frame, true, person.gauges);
        person.window->show(person.frame, false, person.gauges);
        test::check_controls();
      }
    }
  }

  TEST_CASE("a mode shows the settings that work in it, and no other") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    const auto names_in = [&](flow::Mode mode) {
      person.frame.settings.mode = mode;
      person.window->show(person.frame, true, person.gauges);
      person.window->show(person.frame, false, person.gauges);
      std::vector<std::string> names;
      for (const std::string name : {"radius", "c2", "inflate", "whole hand", "never folds",
                                     "volume", "closed pinches", "smooth hands"})
        if (control_named(name) != nullptr) names.push_back(name);
      return names;
    };
    using Names = std::vector<std::string>;
    CHECK(names_in(flow::Mode::type1) == Names{"radius", "c2", "whole hand", "never folds",
                                               "volume", "closed pinches", "smooth hands"});
    CHECK(names_in(flow::Mode::type2) == Names{"radius", "c2", "inflate", "never folds", "volume",
                                               "closed pinches", "smooth hands"});
    CHECK(names_in(flow::Mode::clay) == Names{"smooth hands"});
    CHECK(names_in(flow::Mode::parts) == Names{"closed pinches", "smooth hands"});
  }

  TEST_CASE("each control says what it is for when the pointer is over it, also a grey one") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person({{900, 1600}, Theme::light, 1.0F});
    for (const std::string section : {"Model", "View", "Gloves", "Timing"}) {
      person.press(section);
      person.set(person.frame.settings); // the panel grows
    }
    const auto point = [&](const Eigen::Vector2d& pixel) {
      SimulatedInput input;
      input.pointer = pixel;
      person.hold(input);
    };
    flow::LoopSettings settings = person.frame.settings;
    settings.brushes.fill(deform::Brush::inflate); // and so a strength
    for (const flow::Mode mode :
         {flow::Mode::type1, flow::Mode::type2, flow::Mode::clay, flow::Mode::parts}) {
      settings.mode = mode;
      person.set(settings);
      CHECK(controls().size() > 30);
      test::check_tooltips(point);
    }
    settings.mode = flow::Mode::type1;
    person.set(settings);
    const auto tooltip_of = [&](const char* name) {
      const Control& control = *control_named(name);
      point(((control.min + control.max) / 2.0F).cast<double>());
      return tooltip();
    };
    CHECK(tooltip_of("Undo").find("There is nothing to undo.") != std::string::npos);
    for (const char* name : {"radius", "label radius"})
      for (const char* part : {"1 to 40 cm", "[: smaller", "]: larger", "f: set radius"})
        CHECK(tooltip_of(name).find(part) != std::string::npos);
    CHECK(tooltip_of("Clay").starts_with("Clay: "));
  }

  TEST_CASE("f sets the radii by the pointer's way: a circle on the model, and one change") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    person.window->editor().begin(person.test.model, "ball.obj", nullptr);
    flow::LoopSettings settings = person.frame.settings;
    settings.radius_m = {0.1, 0.1, 0.1, 0.1, 0.05};
    person.set(settings);
    const Camera camera = person.window->scene_window().stage_camera();
    const Size seen = person.window->scene_window().scene_size();
    const Vector3d place = camera.eye().normalized() / person.frame.units_per_metre;
    const Eigen::Vector2d middle = *pixel_of(camera, place, seen);
    const auto seen_px = [&](double radius_m) {
      const Vector3d aside = radius_m * camera.axes().row(0).transpose();
      return (*pixel_of(camera, place + aside, seen) - middle).norm();
    };
    SimulatedInput input;
    const auto begin = [&](bool of_strength) {
      input = {};
      input.pointer = middle;
      input.taps = {GLFW_KEY_F};
      input.shift = of_strength;
      CHECK(person.hold(input).empty());
      input.shift = false;
    };
    const auto is_off = [&] { return person.window->message().empty(); };
    begin(false);
    CHECK(person.window->message().starts_with("radius 10.0 cm: "));
    for (int step = 0; step < 20; ++step) { // as many pictures, and no change of the loop
      input.pointer.x() += 3.0;
      CHECK(person.hold(input).empty());
    }
    input.buttons[0] = true;
    const Commands asked = person.hold(input);
    input.buttons[0] = false;
    REQUIRE(asked.size() == 1);
    REQUIRE(std::holds_alternative<flow::ChangeSettings>(asked[0]));
    const flow::LoopSettings chosen = std::get<flow::ChangeSettings>(asked[0]).settings;
    CHECK(std::abs(seen_px(chosen.radius_m[0]) - seen_px(0.1) - 60.0) < seen_px(0.0011));
    CHECK(chosen.radius_m[4] == doctest::Approx(chosen.radius_m[0] / 2.0));
    CHECK(is_off());
    CHECK(person.hold(input).empty());
    person.set(chosen);

    for (const bool by_mouse : {true, false}) { // the old value returns
      begin(false);
      input.pointer = {60.0, 400.0}; // over the panel
      CHECK(person.hold(input).empty());
      CHECK(person.window->message().starts_with("radius 1.0 cm: "));
      input.buttons[1] = by_mouse;
      if (!by_mouse) input.taps = {GLFW_KEY_ESCAPE};
      CHECK(person.hold(input).empty());
      input.buttons[1] = false;
      CHECK(person.hold(input).empty());
      CHECK(is_off());
      CHECK(person.window->settings() == chosen);
    }

    begin(false);
    input.text = U"g1x2,5"; // what is no number is not taken
    CHECK(person.hold(input).empty());
    input.taps = {GLFW_KEY_ENTER};
    CHECK(person.hold(input).size() == 1);
    CHECK(person.window->settings().radius_m[0] == doctest::Approx(0.125));
    CHECK(person.window->settings().radius_m[4] == doctest::Approx(0.0625));

    begin(true);
    CHECK(person.window->message() == commands::no_strength);
  }

  TEST_CASE("f sets the radius of the brush for masks, in each mode, and not that of fingertips") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    PuppetEditor& editor = person.window->editor();
    editor.begin(person.test.model, "ball.obj", nullptr);
    editor.toggle_brush();
    person.frame.settings.mode = flow::Mode::clay;
    person.set(person.frame.settings);
    const double before_cm = 100.0 * editor.brush_radius() / person.frame.units_per_metre;
    SimulatedInput input;
    input.pointer = {500.0, 300.0};
    input.taps = {GLFW_KEY_F};
    CHECK(person.hold(input).empty());
    CHECK(std::abs(std::stod(person.window->message().substr(7)) - before_cm) < 0.06);
    input.text = U"2";
    CHECK(person.hold(input).empty());
    CHECK(100.0 * editor.brush_radius() / person.frame.units_per_metre ==
          doctest::Approx(before_cm));
    input.taps = {GLFW_KEY_ENTER};
    CHECK(person.hold(input).empty());
    CHECK(100.0 * editor.brush_radius() / person.frame.units_per_metre == doctest::Approx(2.0));
  }

  TEST_CASE("F sets the strength of brushes, and modes without radii or strengths refuse") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    flow::LoopSettings settings = person.frame.settings;
    settings.mode = flow::Mode::clay;
    person.set(settings);
    person.type(GLFW_KEY_F);
    CHECK(person.window->message() == commands::no_radius);
    settings.mode = flow::Mode::type2;
    settings.brushes.fill(deform::Brush::push);
    settings.brush_strength = 0.5;
    person.set(settings);
    SimulatedInput input;
    input.pointer = {500.0, 300.0};
    for (const auto& [typed, strength] : {std::pair{U"-0.25", -0.25}, {U"7", 1.0}, {U"", 1.0}}) {
      input.taps = {GLFW_KEY_F};
      input.shift = true;
      CHECK(person.hold(input).empty());
      CHECK(person.window->message().starts_with("strength "));
      input.shift = false;
      input.text = typed;
      CHECK(person.hold(input).empty());
      input.taps = {GLFW_KEY_ENTER};
      const bool is_same = typed[0] == 0; // and not asked for again
      CHECK(person.hold(input).size() == (is_same ? 0 : 1));
      CHECK(person.window->settings().brush_strength == doctest::Approx(strength));
      person.set(person.window->settings());
    }
  }

  TEST_CASE("hints are beside the panel, and go for good with their button") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    CHECK(control_named("Do not show again") == nullptr);
    person.window->show_hints();
    for (int picture = 0; picture < 3; ++picture)
      person.window->show(person.frame, false, person.gauges);
    REQUIRE(control_named("Do not show again") != nullptr);
    CHECK(static_cast<int>(control_named("Do not show again")->min.x()) > panel_right());
    CHECK(person.press("Do not show again").empty());
    CHECK_FALSE(person.window->has_hints());
    person.window->show(person.frame, false, person.gauges);
    CHECK(control_named("Do not show again") == nullptr);
  }

  TEST_CASE("F3 finds a command by words of its name or its help") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Person person;
    CHECK(person.type(GLFW_KEY_F3).empty());
    for (int picture = 0; picture < 3; ++picture)
      person.window->show(person.frame, false, person.gauges);
    SimulatedInput words;
    for (const int letter : {GLFW_KEY_S, GLFW_KEY_U, GLFW_KEY_B}) {
      words.text.push_back(static_cast<char32_t>(letter + 'a' - 'A'));
      person.give(words);
      words.text.clear();
    }
    const Commands asked = person.type(GLFW_KEY_ENTER);
    CHECK(asked == Commands{flow::Subdivide{}});
    const bool had_bones = person.window->scene_window().parts().bones; // not a command of the run
    person.type(GLFW_KEY_F3);
    for (int picture = 0; picture < 3; ++picture)
      person.window->show(person.frame, false, person.gauges);
    words.text = U"bones";
    person.give(words);
    CHECK(person.type(GLFW_KEY_ENTER).empty());
    CHECK(person.window->scene_window().parts().bones == !had_bones);
    CHECK(person.type(GLFW_KEY_G) == Commands{Request::grab}); // the list has closed
  }
}

} // namespace window_panel_test
