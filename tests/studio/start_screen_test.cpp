// The start screen of the studio.

#include <chrono>
#include <thread>

#include <doctest/doctest.h>

#include "studio/seat.hpp"
#include "studio/start_screen.hpp"
#include "support/control_laws.hpp"
#include "support/eventually.hpp"
#include "support/memory_screen.hpp"
#include "support/restraint.hpp"
#include "support/temporary_folder.hpp"

namespace start_screen_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

struct Seat : test::StudioSeat {
  test::TemporaryFolder folder;
  std::unique_ptr<StartScreen> start;
  Wish wish;

  explicit Seat(std::vector<NamedGlove> gloves = {},
                const viewer::WindowLook& look = {{1280, 800}, viewer::Theme::light, 1.0F})
      : StudioSeat(look) {
    ::setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
    start = std::make_unique<StartScreen>(*window, StartOptions{std::move(gloves), {}});
    show = [this] {
      const Wish now = start->show(*window);
      if (is_wish(now)) wish = now;
    };
    show();
    show();
  }
  ~Seat() { ::unsetenv("XDG_STATE_HOME"); }
  Shape shape_after(const std::string& name) {
    wish = {};
    press(name);
    REQUIRE(std::holds_alternative<Shape>(wish));
    return std::get<Shape>(wish);
  }
  bool comes(const std::string& name) {
    return test::eventually([&] {
      show();
      return sees(name);
    });
  }
};

} // namespace

TEST_SUITE("start_screen" * doctest::skip(!test::restraint_is_counted)) {
  TEST_CASE("one click starts each way to shape, with the model that was chosen") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    CHECK(seat.shape_after("Clay").mode == "clay");
    CHECK(seat.shape_after("Clay").model.empty());
    CHECK(seat.shape_after("Pull").mode == "type1");
    CHECK(seat.shape_after("Puppet").puppet == "face");
    seat.press("Spot");
    CHECK(seat.shape_after("Strokes").model.ends_with("spot.obj"));
    CHECK(seat.shape_after("Strokes").mode == "type2");
    CHECK(seat.shape_after("Puppet").puppet == "spot");
    seat.press("Head"); // which has no puppet: one is begun
    CHECK(seat.shape_after("Puppet").puppet.ends_with("head.puppet.toml"));
    CHECK(seat.shape_after("Puppet").model.ends_with("head.obj"));
    seat.press("Head"); // a second click chooses none again
    CHECK(seat.shape_after("Clay").model.empty());
  }

  TEST_CASE("the hands are the found ones, or simulated ones that move or rest") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    CHECK(seat.shape_after("Pull").hands == Hands::found);
    seat.press("Hands");
    seat.press("choice simulated, still");
    CHECK(seat.shape_after("Pull").hands == Hands::still);
    seat.press("Hands");
    seat.press("choice simulated, moving");
    CHECK(seat.shape_after("Pull").hands == Hands::moving);
  }

  TEST_CASE("a glove that streams is shown with its hand, and one that is not there says why") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat({{"sim:wave?hand=left"}, {"serial:/dev/there-is-no-such-port"}});
    CHECK(seat.comes("simulated glove, 22 sensors, motion wave, left hand"));
    CHECK(seat.comes("serial:/dev/there-is-no-such-port"));
    REQUIRE(seat.comes("Calibrate again..."));
    seat.press("Calibrate again...");
    REQUIRE(std::holds_alternative<Go>(seat.wish));
    CHECK(std::get<Go>(seat.wish).screen == Screen::calibration);
    CHECK(std::get<Go>(seat.wish).glove.spec == "sim:wave?hand=left");
  }

  TEST_CASE("a glove that does not know its hand is shown on the one that was named for it") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat({{"sim:rest", Side::left}});
    REQUIRE(seat.comes("simulated glove, 22 sensors, motion rest, left hand"));
    REQUIRE(seat.comes("Calibrate again..."));
    seat.press("Calibrate again...");
    REQUIRE(std::holds_alternative<Go>(seat.wish));
    CHECK(std::get<Go>(seat.wish).glove.side == Side::left);
  }

  TEST_CASE("no two controls overlap, and no text is cut, at any size") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    for (const viewer::WindowLook look :
         {viewer::WindowLook{{1280, 720}, viewer::Theme::light, 1.0F},
          viewer::WindowLook{{1920, 1080}, viewer::Theme::dark, 1.0F},
          viewer::WindowLook{{2560, 1440}, viewer::Theme::light, 2.0F},
          viewer::WindowLook{{3840, 2160}, viewer::Theme::light, 2.0F}}) {
      Seat seat({{"sim"}}, look);
      CAPTURE(look.size.width);
      REQUIRE(seat.comes("Calibrate again..."));
      seat.show();
      test::check_controls();
    }
  }
}

} // namespace start_screen_test
