// The bar of the studio, and its dialogs.

#include <filesystem>
#include <utility>

#include <GLFW/glfw3.h>
#include <doctest/doctest.h>

#include "session/kept_state.hpp"
#include "studio/bar.hpp"
#include "studio/seat.hpp"
#include "support/memory_screen.hpp"
#include "support/restraint.hpp"
#include "support/temporary_folder.hpp"
#include "support/text_files.hpp"

namespace bar_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

struct Seat : test::StudioSeat {
  test::TemporaryFolder folder;
  Bar bar{*window};
  BarState state{Screen::shaping, "bust.obj", true, true};

  Seat() {
    ::setenv("XDG_STATE_HOME", folder.path().c_str(), 1);
    test::write_file(folder.path() / "one.obj", "v 0 0 0\n");
    test::write_file(folder.path() / "notes.txt", "");
    std::filesystem::create_directory(folder.path() / "scans");
    show = [this] {
      bar.set(state);
      window->begin_picture({}, false);
      window->end_picture();
    };
    show();
    show();
  }
  ~Seat() { ::unsetenv("XDG_STATE_HOME"); }
  std::string at(const std::string& name) const { return (folder.path() / name).string(); }
};

template <class T>
const T* wish_of(Wish& wish, Seat& seat) {
  wish = seat.bar.take_wish();
  return std::get_if<T>(&wish);
}

} // namespace

TEST_SUITE("bar" * doctest::skip(!test::restraint_is_counted)) {
  TEST_CASE("a tab asks for its screen, and the present one for nothing") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    Wish wish;
    seat.press("Timeline");
    REQUIRE(wish_of<Go>(wish, seat) != nullptr);
    CHECK(std::get<Go>(wish).screen == Screen::timeline);
    seat.press("Shaping");
    CHECK_FALSE(is_wish(seat.bar.take_wish()));
    seat.press("File");
    seat.press("Quit");
    CHECK(wish_of<Quit>(wish, seat) != nullptr);
  }

  TEST_CASE("the dialog to open lists folders and models, enters folders, and takes a typed path") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    session::keep_recent_file(seat.at("one.obj"));
    seat.key(GLFW_KEY_O, true);
    CHECK(seat.sees("one.obj"));
    CHECK(seat.sees("scans/"));
    CHECK_FALSE(seat.sees("notes.txt"));
    CHECK_FALSE(seat.control("Open")->is_possible);
    seat.press("scans/");
    CHECK_FALSE(seat.sees("one.obj"));
    seat.press("Up");
    seat.press("one.obj");
    seat.press("Open");
    Wish wish;
    REQUIRE(wish_of<Open>(wish, seat) != nullptr);
    CHECK(std::get<Open>(wish).file == seat.at("one.obj"));
    CHECK_FALSE(seat.bar.has_dialog());

    seat.key(GLFW_KEY_O, true);
    seat.press("file name");
    seat.type(seat.at("nothing.obj"));
    CHECK_FALSE(seat.control("Open")->is_possible); // it is not there
    seat.press("Cancel");
    CHECK_FALSE(is_wish(seat.bar.take_wish()));
  }

  TEST_CASE("the dialog to save adds an ending, and says when it replaces a file") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    seat.key(GLFW_KEY_S, true, true);
    REQUIRE(seat.sees("Save"));
    seat.press("file name");
    seat.key(GLFW_KEY_A, true);
    seat.type(seat.at("two"));
    seat.press("Save");
    CHECK(seat.bar.take_save() == seat.at("two.obj"));
    CHECK_FALSE(seat.bar.take_save());

    seat.key(GLFW_KEY_S, true, true);
    seat.press("file name");
    seat.key(GLFW_KEY_A, true);
    seat.type(seat.at("one.obj"));
    CHECK_FALSE(seat.sees("Save"));
    seat.press("Replace");
    CHECK(seat.bar.take_save() == seat.at("one.obj"));
  }

  TEST_CASE("what was saved or opened last is first among the recent files, once") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    test::write_file(seat.folder.path() / "two.obj", "");
    for (const char* name : {"one.obj", "two.obj", "one.obj", "gone.obj"})
      session::keep_recent_file(seat.at(name));
    CHECK(session::recent_files() == std::vector{seat.at("one.obj"), seat.at("two.obj")});
  }

  TEST_CASE("a question has an answer, and an error a message, before anything else is pressed") {
    const test::MemoryScreen screen;
    if (!screen.is_there()) return;
    Seat seat;
    for (const auto& [name, answer] :
         {std::pair{"Save", Answer::save}, {"Discard", Answer::discard}, {"Stay", Answer::stay}}) {
      seat.bar.ask("bust.obj");
      seat.show();
      seat.show();
      seat.press("Timeline"); // behind the question
      CHECK_FALSE(is_wish(seat.bar.take_wish()));
      CHECK(seat.bar.has_dialog());
      seat.press(name);
      CHECK(seat.bar.take_answer() == answer);
      CHECK_FALSE(seat.bar.has_dialog());
    }
    seat.key(GLFW_KEY_S, true, true);
    REQUIRE(seat.bar.has_dialog());
    seat.bar.ask("bust.obj"); // when the window is closed, in place of the dialog
    seat.show();
    seat.show();
    seat.press("Stay");
    seat.show();
    CHECK_FALSE(seat.bar.has_dialog());
    CHECK_FALSE(seat.bar.take_save());
    seat.bar.take_answer();
    seat.bar.show_error("bust.obj: cannot be read");
    seat.show();
    seat.show();
    seat.press("Close");
    CHECK_FALSE(seat.sees("Close"));
  }
}

} // namespace bar_test
