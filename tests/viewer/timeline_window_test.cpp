// The window of `nendo edit view`, with a mouse and a keyboard that the test simulates.

#include <cmath>

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include "support/control_laws.hpp"
#include "support/flow_fixtures.hpp"
#include "support/memory_screen.hpp"
#include "support/open_window.hpp"
#include "support/restraint.hpp"
#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/timeline_window.hpp"

namespace timeline_window_test {

using namespace nendo;
using namespace nendo::render;
using namespace nendo::viewer;
using namespace nendo::forms;
using Eigen::Vector2d;
using Eigen::Vector3d;

namespace {

constexpr Size size{800, 600};
constexpr double rate_hz = 50.0;

/// A window over a ball and two hands, with keys on two lanes.
struct Seat {
  test::LoopUnderTest test{flow::Mode::type1, {.rings_of_ball = 12}};
  std::unique_ptr<TimelineWindow> window;
  TimelineView view;
  SceneFrame scene_frame;
  SimulatedInput input;
  DopeSheet strip;
  double scale;

  explicit Seat(const WindowLook& look = {size, Theme::dark, 1.0F})
      : scale(static_cast<double>(*look.scale)) {
    window = std::make_unique<TimelineWindow>(test::open_window(look));
    window->scene_window().set_model(test.loop->changes().layout(),
                                     SceneBuilder(test.model, test.placement.units_per_metre));
    const flow::Frame& frame = test.frame_after_tick(0);
    window->scene_window().follow(frame.shape);
    set_hands(frame, {}, scene_frame);
    view.file = "take.timeline.toml";
    view.duration_s = 4.0;
    view.rate_hz = rate_hz;
    view.lanes = {{Side::left, {0.0, 1.0, 4.0}}, {Side::right, {0.5, 2.0, 2.5, 3.5}}};
    view.marks = {{0.8, "commit"}};
    strip.fit(look.size.width / scale - 12.0, view.duration_s);
    show();
  }
  EditActions show() { return window->show(view, scene_frame); }
  Vector2d on_strip(double time_s, double y) const {
    const auto sheet = std::ranges::find(controls(), "dope sheet", &Control::name);
    REQUIRE(sheet != controls().end());
    return sheet->min.cast<double>() + scale * Vector2d(strip.x_of(time_s), y);
  }
  Vector2d on_key(std::size_t lane, std::size_t key) const {
    return on_strip(view.lanes[lane].keys_s[key], DopeSheet::middle_of(lane));
  }
  EditActions move(const Vector2d& pointer, bool left) {
    input.pointer = pointer;
    input.buttons[0] = left;
    window->scene_window().simulate(input);
    return show();
  }
  EditActions press(const Vector2d& pointer) {
    move(pointer, false);
    return move(pointer, true);
  }
  EditActions release() { return move(input.pointer, false); }
  /// A key goes down and up.
  EditActions type(int key, bool control = false, bool shift = false) {
    input.key = key;
    input.control = control;
    input.shift = shift;
    window->scene_window().simulate(input);
    auto actions = show();
    input.key = 0;
    input.control = input.shift = false;
    window->scene_window().simulate(input);
    show();
    return actions;
  }
  Vector2d seen_at(const Vector3d& place_m) const {
    const Camera camera = window->scene_window().stage_camera();
    const Size scene = window->scene_window().scene_size();
    const Eigen::Vector4d clip =
        camera.projection(1.0 * scene.width / scene.height) * place_m.homogeneous();
    return {(1.0 + clip.x() / clip.w()) / 2 * scene.width,
            (1.0 - clip.y() / clip.w()) / 2 * scene.height};
  }
};

/// A seat at a screen, where there can be one.
struct Desk {
  test::MemoryScreen screen;
  std::unique_ptr<Seat> seat;

  Desk() {
    if (!test::restraint_is_counted) return; // Mesa's own memory is not for our sanitizers
    if (!screen.is_there()) {
      MESSAGE("no Xvfb here, so the window is not tested; tools/setup check installs it");
      return;
    }
    seat = std::make_unique<Seat>();
    const auto none = seat->move({400.0, 200.0}, false);
    CHECK(none.commands.empty());
    CHECK_FALSE((none.select || none.seek_s || none.tried || none.keep || none.quit));
  }
};

const KeyDrag& key_drag(const EditActions& actions) {
  REQUIRE(actions.tried);
  REQUIRE(std::holds_alternative<KeyDrag>(*actions.tried));
  return std::get<KeyDrag>(*actions.tried);
}

} // namespace

TEST_SUITE("timeline_window") {
  TEST_CASE("on a dense screen all is larger, keys are where they are seen, and nothing overlaps") {
    if (!test::restraint_is_counted) return;
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    for (const WindowLook& look :
         {WindowLook{{1280, 720}, Theme::light, 1.0F}, WindowLook{{1920, 1080}, Theme::dark, 1.5F},
          WindowLook{{3840, 2160}, Theme::light, 2.0F}}) {
      Seat seat(look);
      for (const char* const name : {"jawOpen", "mouthSmileLeft", "mouthSmileRight", "browUpRight"})
        seat.view.functions.push_back({name, -0.25, {0.0F, 0.5F, -0.25F, 1.0F}});
      const auto pressed = seat.press(seat.on_key(1, 2));
      REQUIRE(pressed.select);
      CHECK(*pressed.select == StripKey{1, 2});
      seat.release();
      test::check_controls();
      test::check_tooltips([&](const Vector2d& pixel) {
        seat.move(pixel, false);
        seat.show();
      });
    }
  }

  TEST_CASE("a click selects a key, and a drag moves it to whole frames, or copies it") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    const auto pressed = seat.press(seat.on_key(1, 2));
    REQUIRE(pressed.select);
    CHECK(*pressed.select == StripKey{1, 2});
    const auto still = seat.move(seat.input.pointer + Vector2d(1.0, 0.0), true);
    CHECK_FALSE(still.tried); // a hand trembles
    const Vector2d there = seat.on_strip(2.81, DopeSheet::middle_of(1));
    const auto dragged = seat.move(there, true);
    CHECK(key_drag(dragged).key == StripKey{1, 2});
    CHECK(std::abs(key_drag(dragged).to_s - 2.81) <= 0.5 / rate_hz + 0.01);
    const double frames = key_drag(dragged).to_s * rate_hz;
    CHECK(frames == doctest::Approx(std::round(frames)));
    CHECK_FALSE(key_drag(dragged).copy);
    CHECK_FALSE(dragged.keep);
    seat.input.control = true;
    CHECK(key_drag(seat.move(there, true)).copy);
    seat.input.control = false;
    CHECK(key_drag(seat.move({1e5, there.y()}, true)).to_s == seat.view.duration_s);
    const auto released = seat.release();
    CHECK(released.keep);
    CHECK_FALSE(released.tried);
    CHECK_FALSE(seat.release().keep);
  }

  TEST_CASE("Esc gives a drag up, and without one selects nothing") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    seat.press(seat.on_key(0, 1));
    seat.move(seat.on_strip(1.5, DopeSheet::middle_of(0)), true);
    seat.input.key = GLFW_KEY_ESCAPE;
    const auto given_up = seat.move(seat.input.pointer, true);
    CHECK(given_up.drop);
    CHECK(given_up.commands.empty());
    seat.input.key = 0;
    CHECK_FALSE(seat.release().keep);
    CHECK(seat.type(GLFW_KEY_ESCAPE).commands == std::vector{EditCommand::select_none});
  }

  TEST_CASE("elsewhere on the strip the play head follows the mouse, at a mark exactly") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    const auto pressed = seat.press(seat.on_strip(1.5, DopeSheet::middle_of(0)));
    REQUIRE(pressed.seek_s);
    CHECK(*pressed.seek_s == doctest::Approx(1.5).epsilon(0.01));
    const auto dragged = seat.move(seat.on_strip(3.0, -100.0), true);
    REQUIRE(dragged.seek_s);
    CHECK(*dragged.seek_s == doctest::Approx(3.0).epsilon(0.01));
    CHECK_FALSE(dragged.tried);
    seat.release();
    const auto at_mark =
        seat.press(seat.on_strip(0.8, DopeSheet::middle_of(2)) + Vector2d(2.0, 0.0));
    CHECK(at_mark.seek_s == 0.8);
  }

  TEST_CASE("what the panel covers does not count as the scene's middle") {
    const Desk desk;
    if (!desk.seat) return;
    const SceneWindow& scene = desk.seat->window->scene_window();
    const Vector2d middle = desk.seat->seen_at(scene.stage_camera().target);
    CHECK(middle.x() == doctest::Approx((310.0 + scene.scene_size().width) / 2.0).epsilon(1e-3));
    CHECK(middle.y() == doctest::Approx(scene.scene_size().height / 2.0).epsilon(1e-3));
  }

  TEST_CASE("pictures are shown where the strip asked for them, also when it is zoomed") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    for (const double wheel : {0.0, 6.0, 0.0}) {
      seat.input.wheel = wheel;
      seat.move(seat.on_strip(1.0, DopeSheet::middle_of(0)), false);
      seat.input.wheel = 0.0;
      if (wheel > 0.0) seat.strip.zoom(seat.strip.x_of(1.0), wheel);
      const auto cells = seat.move({400.0, 200.0}, false).cells;
      seat.view.pictures = cells;
      for (std::size_t at = 0; at < cells.size(); ++at)
        seat.view.pictures[at].image = std::make_shared<const Image>(
            Size{280, 112}, at % 2 == 0 ? Pixel{200, 0, 0} : Pixel{0, 200, 0});
      seat.view.pictures.back().image = nullptr;
      seat.show();
      const Image shown = seat.window->scene_window().screenshot();
      REQUIRE(cells.size() > 3);
      for (std::size_t at = 1; at + 1 < cells.size(); ++at) {
        const Vector2d middle = seat.on_strip((cells[at].from_s + cells[at].to_s) / 2.0,
                                              DopeSheet::ruler + DopeSheet::pictures / 2.0);
        CHECK(shown.at(static_cast<int>(middle.x()), static_cast<int>(middle.y())) ==
              (at % 2 == 0 ? Pixel{200, 0, 0} : Pixel{0, 200, 0}));
      }
    }
  }

  TEST_CASE("the wheel zooms about the pointer") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    const Vector2d pointer = seat.on_strip(2.0, DopeSheet::middle_of(1));
    seat.move(pointer, false);
    seat.input.wheel = 3.0;
    seat.move(pointer, false);
    seat.input.wheel = 0.0;
    seat.strip.zoom(pointer.x() - 6.0, 3.0);
    CHECK(*seat.press(seat.on_key(1, 2)).select == StripKey{1, 2});
  }

  TEST_CASE(
      "a fingertip of the selected key's hand follows the mouse, and without one the camera does") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    const auto tips = seat.scene_frame.hands[1]->pose.fingertip_positions();
    Eigen::Index finger = 0; // one that the panel does not cover
    while (finger < 4 && seat.seen_at(tips.col(finger)).x() < 330.0)
      ++finger;
    const Vector2d tip = seat.seen_at(tips.col(finger));
    const Vector2d away(14.0, -9.0);
    seat.press(tip); // nothing is selected
    const double azimuth_deg = seat.window->scene_window().camera().view.azimuth_deg;
    CHECK_FALSE(seat.move(tip + away, true).tried);
    CHECK(seat.window->scene_window().camera().view.azimuth_deg != azimuth_deg);
    seat.move(tip, true); // back
    seat.release();
    CHECK(seat.window->scene_window().camera().view.azimuth_deg == doctest::Approx(azimuth_deg));
    seat.view.selected = StripKey{1, 1};
    seat.view.at_selected = true;
    seat.press(tip);
    const auto dragged = seat.move(tip + away, true);
    REQUIRE(dragged.tried);
    const auto& drag = std::get<TipDrag>(*dragged.tried);
    CHECK(drag.finger == static_cast<hand::Finger>(finger));
    CHECK((seat.seen_at(drag.target_m) - tip - away).norm() < 0.5);
    CHECK(seat.window->scene_window().camera().view.azimuth_deg == doctest::Approx(azimuth_deg));
    CHECK(seat.release().keep);
  }

  TEST_CASE("each key of the table asks for its row's command, and q to quit") {
    const Desk desk;
    if (!desk.seat) return;
    CHECK(desk.seat->type(GLFW_KEY_Q).quit);
    for (const commands::Row& row : commands::table())
      for (const std::string_view key : row.keys) {
        if (!row.edit || key.empty()) continue;
        CAPTURE(key);
        const KeyStroke stroke = stroke_of(key);
        const auto asked = desk.seat->type(stroke.key, stroke.control, stroke.shift).commands;
        CHECK(asked == std::vector{row.edit->command});
      }
  }

  TEST_CASE("Home has all of the model in the picture again, as in the window of a run") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    seat.type(GLFW_KEY_HOME);
    const Camera framed = seat.window->scene_window().camera();
    seat.input.wheel = 3.0;
    seat.move({500.0, 200.0}, false);
    seat.input.wheel = 0.0;
    CHECK(seat.window->scene_window().camera().distance_m != framed.distance_m);
    CHECK(seat.type(GLFW_KEY_HOME).commands.empty());
    CHECK(seat.window->scene_window().camera().distance_m == doctest::Approx(framed.distance_m));
  }

  TEST_CASE("? and F3 list the commands, which a click gives, and grey ones say why") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    const auto row = [](const std::string& name) -> std::optional<Vector2d> {
      for (const Control& control : controls())
        if (control.name == "found " + name)
          return ((control.min + control.max) / 2.0F).cast<double>();
      return std::nullopt;
    };
    for (const int key : {GLFW_KEY_SLASH, GLFW_KEY_F3}) {
      CHECK_FALSE(row("play"));
      CHECK(seat.type(key).commands.empty());
      for (int picture = 0; picture < 3; ++picture)
        seat.show();
      REQUIRE(row("play"));
      seat.input.control = true; // which closes nothing
      seat.move(*row("copy key"), false);
      seat.show();
      CHECK(tooltip().find("No key is selected") != std::string::npos);
      seat.input.control = false;
      seat.press(*row("play"));
      CHECK(seat.release().commands == std::vector{EditCommand::play});
      seat.show();
    }
  }

  TEST_CASE("a key that was down only between two pictures counts, and twice if it was twice") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    seat.input.control = true;
    seat.input.taps = {GLFW_KEY_LEFT_CONTROL, GLFW_KEY_Z, GLFW_KEY_Z, GLFW_KEY_Y};
    seat.window->scene_window().simulate(seat.input);
    std::vector<EditCommand> commands;
    for (int picture = 0; picture < 4; ++picture) {
      const auto actions = seat.show();
      commands.insert(commands.end(), actions.commands.begin(), actions.commands.end());
      seat.input = {};
      seat.window->scene_window().simulate(seat.input);
    }
    using enum EditCommand;
    CHECK(commands == std::vector{undo, undo, redo});
  }

  TEST_CASE("a press is where the pointer was, though it has moved on before the picture") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    const Vector2d key = seat.on_key(1, 1);
    seat.input.clicked_at = key;
    const Vector2d there = key + Vector2d(40.0, 0.0);
    CHECK(*seat.move(there, true).select == StripKey{1, 1});
    seat.input.clicked_at.reset();
    CHECK(key_drag(seat.move(there, true)).to_s > seat.view.lanes[1].keys_s[1] + 0.1);
  }

  TEST_CASE("the picture shows the selected key, and where the play head is") {
    const Desk desk;
    if (!desk.seat) return;
    Seat& seat = *desk.seat;
    const Image before = seat.window->scene_window().screenshot();
    CHECK(before.size() == size);
    seat.view.selected = StripKey{0, 1};
    seat.show();
    const Image after = seat.window->scene_window().screenshot();
    const Vector2d key = seat.on_key(0, 1);
    const auto colour = [&](const Image& image) {
      return image.at(static_cast<int>(key.x()), static_cast<int>(key.y()));
    };
    CHECK(colour(before) != colour(after));
  }
}

} // namespace timeline_window_test
