// The timeline of the studio, whose unsaved edits are not lost without a question.

#include <filesystem>

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include "studio/seat.hpp"
#include "studio/timeline_tab.hpp"
#include "support/memory_screen.hpp"
#include "support/restraint.hpp"
#include "support/temporary_folder.hpp"
#include "support/test_meshes.hpp"
#include "support/timelines.hpp"

namespace timeline_tab_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

struct Seat : test::StudioSeat {
  test::TemporaryFolder folder;
  std::string out = (folder.path() / "wave.timeline.toml").string();
  Bar bar{*window};
  TimelineTab tab{window, bar};

  Seat() {
    const deform::Mesh model = test::sphere(12, 24, 1.0);
    auto frames =
        takes::TimelineFrames::make(test::waved_timeline(model, flow::Mode::type1), model);
    REQUIRE(frames);
    tab.open(
        FirstTimeline{"wave.nendo", out, *std::move(frames), timeline::KeyRef{Side::right, 3}});
    show = [this] { REQUIRE(tab.show()); };
    show();
  }
  void edit(forms::EditCommand command) {
    forms::EditActions actions;
    actions.commands = {command};
    tab.session()->handle(actions);
  }
};

bool quits(const Wish& wish) {
  return std::holds_alternative<Quit>(wish);
}

} // namespace

TEST_SUITE("timeline_tab" * doctest::skip(!test::restraint_is_counted)) {
  TEST_CASE("leaving a timeline without edits, and other screens, asks nothing") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    CHECK(seat.tab.lets(Quit{}));
    seat.edit(forms::EditCommand::delete_key);
    REQUIRE(seat.tab.is_modified());
    CHECK(seat.tab.lets(Go{Screen::start}));
    CHECK(seat.tab.lets(Open{"bust.obj"}));
    CHECK_FALSE(seat.bar.has_dialog());
  }

  TEST_CASE("edits are saved, discarded or kept as the user answers") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    seat.edit(forms::EditCommand::delete_key);
    REQUIRE_FALSE(seat.tab.lets(Open{"other.nendo"}));
    seat.show();
    seat.show();
    seat.press("Stay");
    CHECK_FALSE(is_wish(seat.tab.take_settled()));
    CHECK(seat.tab.is_modified());

    REQUIRE_FALSE(seat.tab.lets(Quit{}));
    seat.show();
    seat.show();
    seat.press("Discard");
    CHECK(quits(seat.tab.take_settled()));
    CHECK(seat.tab.lets(Quit{})); // the answer holds for these edits
    CHECK_FALSE(std::filesystem::exists(seat.out));

    seat.edit(forms::EditCommand::undo);
    seat.edit(forms::EditCommand::mirror);
    REQUIRE_FALSE(seat.tab.lets(Quit{})); // and not for others
    seat.show();
    seat.show();
    seat.press("Save");
    CHECK(quits(seat.tab.take_settled()));
    CHECK_FALSE(seat.tab.is_modified());
    CHECK(std::filesystem::exists(seat.out));

    seat.edit(forms::EditCommand::mirror);
    std::filesystem::remove_all(seat.folder.path()); // so that nothing can be saved there
    REQUIRE_FALSE(seat.tab.lets(Quit{}));
    seat.show();
    seat.show();
    seat.press("Save");
    CHECK_FALSE(is_wish(seat.tab.take_settled()));
    CHECK(seat.tab.is_modified());
  }

  TEST_CASE("the key q of the timeline asks to quit, and the tab asks about its edits") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    seat.edit(forms::EditCommand::delete_key);
    viewer::SimulatedInput input;
    input.taps = {GLFW_KEY_Q};
    seat.window->simulate(input);
    const auto wish = seat.tab.show();
    REQUIRE(wish);
    REQUIRE(quits(*wish));
    CHECK_FALSE(seat.tab.lets(*wish));
    seat.window->simulate({});
    seat.show();
    seat.show();
    const std::uint64_t revision = seat.tab.session()->history().revision();
    seat.key(GLFW_KEY_Y, false, true); // the question comes first
    CHECK(seat.tab.session()->history().revision() == revision);
    seat.key(GLFW_KEY_ESCAPE); // stays
    CHECK_FALSE(is_wish(seat.tab.take_settled()));
    const auto next = seat.tab.show();
    REQUIRE(next);
    CHECK_FALSE(is_wish(*next));
    seat.key(GLFW_KEY_Y, false, true);
    CHECK(seat.tab.session()->history().revision() != revision);
  }
}

} // namespace timeline_tab_test
