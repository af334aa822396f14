// A calibration in the studio's window, whose poses are not lost without a question.

#include <doctest/doctest.h>

#include "studio/seat.hpp"
#include "studio/window_calibration.hpp"
#include "support/eventually.hpp"
#include "support/memory_screen.hpp"
#include "support/restraint.hpp"

namespace window_calibration_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

struct Seat : test::StudioSeat {
  Bar bar{*window};
  WindowCalibration calibration{*window, bar, {"sim:rest", Side::left}};

  Seat() {
    show = [this] { REQUIRE(calibration.show(*window)); };
  }
  bool comes(const std::string& name) {
    return test::eventually([&] {
      show();
      return sees(name);
    });
  }
  /// The button of the calibration, and not the tab of that name.
  const viewer::Control* start() const {
    const viewer::Control* last = nullptr;
    for (const viewer::Control& one : viewer::controls())
      if (one.name == "Start") last = &one;
    return last;
  }
  /// The hand that rests is taken for a flat one.
  void take_pose() {
    REQUIRE(comes("your name"));
    show(); // a new panel finds its size first
    show();
    press("your name");
    type("anna");
    REQUIRE(test::eventually([&] {
      show();
      return start()->is_possible;
    }));
    press(*start());
    CHECK(calibration.lets(Go{Screen::start})); // no pose yet
    REQUIRE(comes("Begin"));
    press("Begin");
    REQUIRE(comes("Taken. Now take this pose."));
  }
  void ask(const Wish& wish) {
    REQUIRE_FALSE(calibration.lets(wish));
    show();
    show();
    REQUIRE(sees("Stay"));
    CHECK_FALSE(sees("Save"));
  }
};

} // namespace

TEST_SUITE("window_calibration" * doctest::skip(!test::restraint_is_counted)) {
  TEST_CASE("leaving a calibration asks once a pose is taken, and discards it or stays") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    CHECK(seat.calibration.lets(Quit{})); // the glove is being opened
    seat.take_pose();
    CHECK(seat.calibration.lets({}));
    seat.ask(Go{Screen::start});
    CHECK_FALSE(is_wish(seat.calibration.take_settled()));
    seat.press("Stay");
    CHECK_FALSE(is_wish(seat.calibration.take_settled()));
    seat.ask(Quit{});
    seat.press("Discard");
    CHECK(std::holds_alternative<Quit>(seat.calibration.take_settled()));
    CHECK_FALSE(is_wish(seat.calibration.take_settled()));
  }
}

} // namespace window_calibration_test
