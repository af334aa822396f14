#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "answering_form.hpp"
#include "forms/timeline_panel.hpp"

namespace timeline_panel_test {

using namespace nendo;
using namespace nendo::forms;
using test::AnsweringForm;

namespace {

TimelineView view_of(double duration_s) {
  TimelineView view;
  view.file = "take.timeline.toml";
  view.duration_s = duration_s;
  view.rate_hz = 50.0;
  view.lanes = {{Side::left, {0.0, duration_s}}, {Side::right, {0.25 * duration_s}}};
  return view;
}

/// A timeline of 4 s, and a user.
struct Seat {
  TimelinePanel panel;
  AnsweringForm form;
  TimelineView view = view_of(4.0);

  Seat() { describe(); }
  EditActions describe() {
    EditActions actions;
    form.names.clear();
    panel.describe(form, view, actions);
    panel.describe_strip(form, view, actions);
    form.pressed.clear();
    form.typed.clear();
    return actions;
  }
  /// The pointer with the main button, over a time of a lane.
  EditActions point(double time_s, std::size_t lane, bool is_pressed, bool is_held) {
    DopeSheet strip;
    strip.fit(form.pointer.width, view.duration_s);
    form.pointer.at = Eigen::Vector2d(strip.x_of(time_s), DopeSheet::middle_of(lane));
    form.pointer.is_pressed = is_pressed;
    form.pointer.is_held = is_held;
    return describe();
  }
};

} // namespace

TEST_SUITE("timeline_panel") {
  TEST_CASE("a key that is dragged moves to whole frames, and stays at the release") {
    Seat seat;
    CHECK(seat.point(1.0, 1, true, true).select == StripKey{1, 0});
    const auto dragged = seat.point(2.017, 1, false, true);
    REQUIRE(dragged.tried);
    CHECK(std::get<KeyDrag>(*dragged.tried).to_s == doctest::Approx(2.02));
    CHECK_FALSE(dragged.keep);
    CHECK(seat.point(2.017, 1, false, false).keep);
    CHECK_FALSE(seat.point(2.017, 1, false, false).keep);
  }

  TEST_CASE("a drag that is given up is dropped once, and a click alone changes nothing") {
    Seat seat;
    const auto strike_esc = [&] {
      EditActions actions;
      seat.panel.add(EditCommand::select_none, actions);
      CHECK(actions.drop != (actions.commands == std::vector{EditCommand::select_none}));
      CHECK_FALSE(actions.keep);
      return actions.drop;
    };
    seat.point(1.0, 1, true, true);
    CHECK_FALSE(strike_esc()); // it has not moved
    seat.point(1.0, 1, true, true);
    seat.point(3.0, 1, false, true);
    CHECK(strike_esc());
    CHECK_FALSE(strike_esc());
    CHECK_FALSE(seat.point(3.5, 1, false, true).tried);
    CHECK_FALSE(seat.point(3.5, 1, false, false).keep);
  }

  TEST_CASE("another command ends a drag, and a pointer that is held still moves nothing") {
    Seat seat;
    seat.point(1.0, 1, true, true);
    CHECK(seat.point(2.0, 1, false, true).tried);
    CHECK_FALSE(seat.point(2.0, 1, false, true).tried);
    EditActions deletes;
    seat.panel.add(EditCommand::delete_key, deletes);
    CHECK(deletes.keep);
    CHECK(deletes.commands == std::vector{EditCommand::delete_key});
    CHECK_FALSE(seat.point(3.0, 1, false, true).tried);
    CHECK_FALSE(seat.point(3.0, 1, false, false).keep);
    seat.point(2.5, 0, true, true);
    CHECK(seat.point(3.5, 0, false, true).seek_s);
    CHECK_FALSE(seat.point(3.5, 0, false, true).seek_s);
  }

  TEST_CASE("a blend is tried while the number is held, and kept once") {
    Seat seat;
    seat.view.selected = StripKey{1, 0};
    for (const bool loses_key : {false, true}) {
      seat.view.selected = StripKey{1, 0};
      seat.form.changes = true;
      for (const float factor : {0.25F, 0.5F}) {
        seat.form.typed["blend"] = factor;
        const auto tried = seat.describe();
        REQUIRE(tried.tried);
        CHECK(std::get<KeyBlend>(*tried.tried).factor == static_cast<double>(factor));
        CHECK_FALSE(tried.keep);
      }
      CHECK_FALSE(seat.describe().keep);
      if (loses_key)
        seat.view.selected.reset();
      else
        seat.form.changes = false;
      CHECK(seat.describe().keep);
      CHECK_FALSE(seat.describe().keep);
    }
  }

  TEST_CASE("a part of the timeline is retimed from and to where the play head was") {
    Seat seat;
    seat.view.head_s = 1.0;
    seat.form.pressed = "From head";
    seat.describe();
    seat.view.head_s = 3.0;
    seat.form.pressed = "To head";
    seat.describe();
    seat.form.typed["times as long"] = 0.5F;
    CHECK_FALSE(seat.describe().retiming);
    seat.form.pressed = "Retime";
    const auto asked = seat.describe();
    REQUIRE(asked.retiming);
    CHECK(asked.retiming->from_s == 1.0);
    CHECK(asked.retiming->to_s == 3.0);
    CHECK(asked.retiming->scale == 0.5);
  }

  TEST_CASE("each button of the table is there once, and gives its command") {
    Seat seat;
    std::size_t buttons = 0;
    for (const commands::Row& row : commands::table()) {
      if (!row.edit || row.group == commands::Buttons::none) continue;
      CAPTURE(row.name);
      ++buttons;
      seat.form.pressed = row.name;
      CHECK(seat.describe().commands == std::vector{row.edit->command});
      CHECK(seat.form.count_of(std::string(row.name)) == 1);
    }
    CHECK(buttons > 12);
    seat.form.pressed = "loop";
    CHECK(seat.describe().commands == std::vector{EditCommand::loop});
  }

  TEST_CASE("however many keys there are, the drawing is in its bounds and small") {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> any(0.0, 1.0);
    for (const double duration_s : {0.0, 1e-3, 4.0, 1e6}) {
      Seat seat;
      seat.view = view_of(duration_s);
      auto& keys_s = seat.view.lanes[0].keys_s;
      for (int key = 0; key < 20'000; ++key)
        keys_s.push_back(duration_s * any(random));
      std::ranges::sort(keys_s);
      for (int mark = 0; mark < 20'000; ++mark)
        seat.view.marks.push_back({duration_s * any(random), std::string(40, 'x')});
      std::ranges::sort(seat.view.marks, {}, &StripMark::time_s);
      seat.view.functions.push_back({"smile", NAN, {0.0F, 1e30F, -1e30F, NAN}});
      for (const auto& [wheel, width] :
           {std::pair{0.0, 800.0}, {3.0, 1.0}, {-1.0, 1e5}, {0.0, 800.0}}) {
        seat.form.pointer.width = width;
        seat.form.pointer.at = Eigen::Vector2d(500.0, 40.0);
        seat.form.pointer.wheel = wheel;
        seat.describe();
        const Drawing& sheet = seat.form.drawings.at("dope sheet");
        CHECK(sheet.width >= 200.0);
        CHECK(sheet.width <= 8'000.0);
        CHECK(sheet.shapes.size() < 200 + 2 * static_cast<std::size_t>(sheet.width));
        for (const Drawing::Shape& shape : sheet.shapes)
          for (const Eigen::Vector2f& point : shape.points) {
            CHECK(point.allFinite());
            CHECK(point.x() >= -200.0F); // of pictures, which are cut
            CHECK(static_cast<double>(point.x()) <= sheet.width + 200.0);
            CHECK(point.y() >= 0.0F);
            CHECK(static_cast<double>(point.y()) <= sheet.height);
          }
      }
    }
  }
}

} // namespace timeline_panel_test
