// The timeline on the page of the studio.

#include <array>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>

#include <doctest/doctest.h>

#include "session/asking_run.hpp"
#include "studio/page.hpp"
#include "studio/page_timeline.hpp"
#include "web/web_client.hpp"
#include "web/wire.hpp"

namespace page_timeline_test {

using namespace nendo;
using namespace nendo::studio;
namespace fs = std::filesystem;

namespace {

constexpr std::size_t vertices = 12 * 24 + 2; // of the timeline's model

struct Seat : test::StudioPage {
  PageTimeline timeline;

  explicit Seat(std::size_t most = web::max_vertices) : timeline(*server, most) {}

  /// Shows a picture, after the user has done this to a control.
  Result<Wish> give(const std::string& control, const std::string& value = "") {
    form.begin(web::FormInput{control, value});
    return timeline.update(form);
  }
  Result<Wish> show() {
    form.begin({});
    return timeline.update(form);
  }
  bool sees(const std::string& words) const {
    return form.message().find(words) != std::string::npos;
  }
  /// Returns the error with which the file cannot be shown; empty: its shapes are made.
  std::string error_of(const Open& file) {
    std::string error;
    timeline.open(file);
    CHECK(test::eventually([&] {
      const auto shown = show();
      if (!shown) error = shown.error().message;
      return !shown || (timeline.session() != nullptr && timeline.session()->progress().done);
    }));
    return error;
  }
  std::size_t keys() const {
    return timeline.session()->history().timeline().hands.at(0).keys.size();
  }
  /// Deletes a key of the first hand.
  void edit() {
    timeline.session()->select(timeline::KeyRef{Side::left, 3});
    REQUIRE(give("delete key"));
    REQUIRE(timeline.is_modified());
  }
  /// Answers the question about unsaved edits.
  Result<Wish> answer(const std::string& name) {
    form.begin(web::FormInput{name, ""});
    return timeline.ask(form);
  }
};

} // namespace

TEST_SUITE("page_timeline") {
  TEST_CASE("a model with more vertices than browsers take is refused, as by --web") {
    Seat small;
    CHECK(small.error_of({small.timeline_file()}).empty());
    Seat large(100);
    CHECK(large.error_of({large.timeline_file()}) ==
          "--web: the model has " + std::to_string(vertices) +
              " vertices, and a browser takes at most 100; run it without --web, or reduce the "
              "model");
    CHECK_FALSE(large.timeline.is_open());
  }

  TEST_CASE("a file that cannot be read is open no more, and removed if a browser sent it") {
    Seat seat;
    for (const bool was_sent : {false, true}) {
      const std::string file = seat.path("bad.timeline.toml");
      std::ofstream(file) << "no timeline";
      CHECK_FALSE(seat.error_of({file, was_sent}).empty());
      CHECK_FALSE(seat.timeline.is_open());
      CHECK(fs::exists(file) != was_sent);
    }
    REQUIRE(seat.show());
    CHECK(seat.sees("Record while the hands shape"));
    const auto wish = seat.give("Open a recording or a timeline...");
    REQUIRE(wish);
    CHECK(std::holds_alternative<Open>(*wish));
  }

  TEST_CASE("keys and buttons of the page edit the timeline") {
    Seat seat;
    REQUIRE(seat.error_of({seat.timeline_file()}).empty());
    const std::size_t before = seat.keys();
    CHECK(seat.timeline.title() == "wave.timeline.toml");
    seat.edit();
    CHECK(seat.keys() == before - 1);
    CHECK(seat.timeline.title() == "wave.timeline.toml *");
    REQUIRE(seat.give("undo edit"));
    CHECK(seat.keys() == before);
    CHECK_FALSE(seat.timeline.is_modified());
    seat.timeline.session()->select(timeline::KeyRef{Side::left, 3});
    REQUIRE(seat.give("forget key"));
    CHECK_FALSE(seat.timeline.session()->history().selected());
    REQUIRE(seat.give("delete key"));
    CHECK(seat.keys() == before);
    REQUIRE(seat.show());
    CHECK(seat.sees(commands::no_key));
  }

  TEST_CASE("a page gets another shape when the play head moves, and none while nothing changes") {
    Seat seat;
    REQUIRE(seat.error_of({seat.timeline_file()}).empty());
    test::WebClient client(*seat.server);
    REQUIRE(client.open_socket() == 101);
    const auto shapes_after = [&](int pictures) {
      for (int picture = 0; picture < pictures; ++picture) {
        REQUIRE(seat.show());
        std::this_thread::sleep_for(std::chrono::milliseconds(10));
      }
      return seat.server->counters().shapes;
    };
    CHECK(test::eventually([&] { return shapes_after(1) == 1; }));
    CHECK(shapes_after(40) == 1);
    REQUIRE(seat.give("next key"));
    CHECK(test::eventually([&] { return shapes_after(1) == 2; }));
    CHECK(shapes_after(40) == 2);
    seat.timeline.leave();
    CHECK(client.close_code() == 1012);
  }

  TEST_CASE("a page has the bones of both hands, also after they are mirrored") {
    Seat seat;
    const std::string file = seat.timeline_file();
    auto one_hand = timeline::read_timeline(file);
    REQUIRE(one_hand);
    one_hand->hands.erase(one_hand->hands.begin());
    one_hand->hands.front().size.length_m = 0.21;
    REQUIRE(timeline::write_timeline(file, *one_hand));
    REQUIRE(seat.error_of({file}).empty());
    const auto bones = [&] {
      test::WebClient client(*seat.server);
      const std::string model = client.get(client.with_token("/model")).body;
      web::ModelHead head;
      REQUIRE(model.size() > sizeof head + 2 * web::bones_bytes);
      std::memcpy(&head, model.data(), sizeof head);
      CHECK((head.flags & 3) == 3);
      return std::array{model.substr(sizeof head, web::bones_bytes),
                        model.substr(sizeof head + web::bones_bytes, web::bones_bytes)};
    };
    const auto before = bones();
    REQUIRE(seat.give("mirror hands"));
    CHECK(test::eventually([&] {
      REQUIRE(seat.show());
      const auto now = bones();
      return now[0] != before[0] && now[1] != before[1];
    }));
  }

  TEST_CASE("edits stay while other screens are shown, and go into the file") {
    Seat seat;
    const std::string file = seat.timeline_file();
    REQUIRE(seat.error_of({file}).empty());
    const std::size_t before = seat.keys();
    seat.edit();
    const edit::EditSession* const session = seat.timeline.session();
    seat.timeline.leave();
    CHECK(seat.timeline.is_modified());
    REQUIRE(seat.give("save timeline"));
    CHECK(seat.timeline.session() == session);
    CHECK_FALSE(seat.timeline.is_modified());
    const auto saved = timeline::read_timeline(file);
    REQUIRE(saved);
    CHECK(saved->hands.at(0).keys.size() == before - 1);
  }

  TEST_CASE("unsaved edits are saved, discarded or kept as the user answers") {
    Seat seat;
    const std::string file = seat.timeline_file();
    REQUIRE(seat.error_of({file}).empty());
    const Open other{seat.timeline_file("other.timeline.toml"), true};
    CHECK(seat.timeline.lets(other));
    seat.edit();
    CHECK(seat.timeline.lets(Go{Screen::start}));
    CHECK(seat.timeline.lets(Open{"bust.obj"}));

    REQUIRE_FALSE(seat.timeline.lets(other));
    auto wish = seat.answer("");
    REQUIRE(wish);
    CHECK_FALSE(is_wish(*wish));
    CHECK(seat.sees("Save the changes to"));
    const std::size_t keys = seat.keys();
    REQUIRE(seat.give("undo edit")); // the question comes first
    CHECK(seat.keys() == keys);
    wish = seat.answer("Stay");
    REQUIRE(wish);
    CHECK_FALSE(is_wish(*wish));
    CHECK_FALSE(seat.timeline.is_asking());
    CHECK_FALSE(fs::exists(other.file)); // which a browser had sent

    REQUIRE_FALSE(seat.timeline.lets(Quit{}));
    wish = seat.answer("Discard");
    REQUIRE(wish);
    CHECK(std::holds_alternative<Quit>(*wish));
    CHECK(seat.timeline.lets(Quit{})); // the answer holds for these edits
    REQUIRE(seat.give("mirror hands"));
    REQUIRE_FALSE(seat.timeline.lets(Quit{})); // and not for others
    wish = seat.answer("Save");
    REQUIRE(wish);
    CHECK(std::holds_alternative<Quit>(*wish));
    CHECK_FALSE(seat.timeline.is_modified());

    REQUIRE(seat.give("mirror hands"));
    fs::remove_all(seat.folder.path()); // so that nothing can be saved there
    REQUIRE_FALSE(seat.timeline.lets(Quit{}));
    CHECK_FALSE(seat.answer("Save"));
    CHECK(seat.timeline.is_modified());
    CHECK_FALSE(seat.timeline.is_asking());
    fs::create_directories(seat.folder.path());
  }

  TEST_CASE("a recording opens as a timeline, which is saved beside it and replaces none") {
    session::asking::Run run;
    run.options.recording.file = (run.folder.path() / "take.nendo").string();
    REQUIRE(run.options.recording.check(run.options.out, flow::SwitchAction::none));
    session::asking::Asker onlooker(session::asking::Changes{{}});
    const std::string take = run.follow({&onlooker}).recordings.at(0).file;
    Seat seat;
    for (const char* const name : {"take.timeline.toml", "take-2.timeline.toml"}) {
      REQUIRE(seat.error_of({take}).empty());
      CHECK(seat.timeline.title() == "take.nendo");
      CHECK_FALSE(fs::exists(run.folder.path() / name));
      REQUIRE(seat.give("save timeline"));
      CHECK(fs::exists(run.folder.path() / name));
    }
  }
}

} // namespace page_timeline_test
