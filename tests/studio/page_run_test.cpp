// A run of the studio on its page, and the timeline beside it.

#include <algorithm>
#include <functional>
#include <optional>
#include <string>
#include <thread>

#include <doctest/doctest.h>

#include "session/place_loop.hpp"
#include "session/run_options.hpp"
#include "session/run_saving.hpp"
#include "studio/page.hpp"
#include "studio/page_run.hpp"
#include "web/web_client.hpp"

namespace page_run_test {

using namespace nendo;
using namespace nendo::studio;

namespace {

/// A run whose frame stays the same.
struct Seat : test::StudioPage {
  deform::Mesh mesh = test::sphere(12, 24, 1.0);
  flow::ModelVersion version{0, mesh, deform::BlockLayout(mesh.vertices), {}, nullptr};
  flow::Frame frame;
  gloves::DeviceStatuses devices;
  std::shared_ptr<const puppet::Rig> puppet;
  session::RunOptions options;
  session::PlacedLoop placed;
  std::vector<gloves::OpenHand> hands;
  session::RunRecorder recorder{options, placed, hands, mesh};
  session::RunSaving saving{options, recorder};
  commands::RunFacts facts;
  std::string recorded;
  PageTimeline timeline{*server};
  std::optional<PageRun> run;
  session::Asks asks;

  Seat() {
    frame.shape = version.layout().pack();
    begin();
  }
  void begin() {
    asks.clear();
    run.emplace(*server, timeline, "ball.ply", true);
    update();
  }
  void update() {
    run->update({frame, version, true, devices, facts, puppet, &saving, recorded}, asks);
  }
  bool comes(const std::function<bool()>& condition) {
    return test::eventually([&] {
      update();
      return condition();
    });
  }
  /// Does this to a control of the page.
  bool press(const std::string& control, const std::function<bool()>& until,
             const std::string& value = "") {
    test::WebClient client(*server);
    return client.open_socket() == 101 && client.send_text("form\t" + control + "\t" + value) &&
           comes(until);
  }
  template <class Command>
  bool has_asked(const Command& wanted) const {
    return std::ranges::any_of(asks, [&](const session::Ask& ask) {
      const auto* const command = std::get_if<flow::Command>(&ask);
      return command != nullptr && *command == flow::Command(wanted);
    });
  }
  /// Returns the text of the message that the page has now.
  std::string seen() {
    test::WebClient client(*server);
    std::string text;
    if (client.open_socket() != 101) return text;
    while (const auto message = client.next(200)) {
      const auto& bytes = message->payload;
      if (bytes.size() < 4 || bytes[0] != std::byte{12} || bytes[1] != std::byte{0}) continue;
      text.assign(reinterpret_cast<const char*>(bytes.data()) + 4, bytes.size() - 4);
      break;
    }
    return text;
  }
  bool sees(const std::string& words) { return seen().find(words) != std::string::npos; }
  /// Shows so many pictures.
  void show(int pictures = 1) {
    for (int picture = 0; picture < pictures; ++picture) {
      std::this_thread::sleep_for(picture_time);
      update();
    }
  }
  /// Opens a file by its name, while the timeline has none.
  void open(const std::string& name, const std::function<bool()>& until) {
    const auto sees_words = [&](const std::string& words) {
      return [this, words] { return sees(words); };
    };
    REQUIRE(press("Open a recording or a timeline...", sees_words("Open a file")));
    REQUIRE(press("file name", sees_words(name), name));
    REQUIRE(press("Open", until));
  }
  /// Opens the file beside the run as its recording, and deletes a key.
  void edit(const std::string& file) {
    recorded = file;
    REQUIRE(press("Timeline", [&] { return timeline.session() != nullptr; }));
    timeline.session()->select(timeline::KeyRef{Side::left, 3});
    REQUIRE(press("delete key", [&] { return timeline.is_modified(); }));
  }
  void send(const std::string& name) {
    test::WebClient client(*server);
    client.send("POST " + client.with_token("/open") + "&name=" + name + " HTTP/1.1\r\nHost: " +
                server->endpoint().authority() + "\r\nContent-Length: 4\r\n\r\nsent");
    CHECK(client.answer().status == 200);
  }
};

} // namespace

TEST_SUITE("page_run") {
  TEST_CASE(
      "the timeline ends the recording, shows it, and the hands release the model meanwhile") {
    Seat seat;
    seat.facts.recorded = true;
    const auto has_released = [&] { return seat.has_asked(flow::Request::release); };
    REQUIRE(seat.press("Timeline", has_released));
    CHECK(seat.has_asked(flow::SetRecording{false}));
    CHECK(seat.sees("Record while the hands shape"));
    seat.facts.recorded = false;
    seat.recorded = seat.timeline_file();
    REQUIRE(seat.comes([&] { return seat.timeline.session() != nullptr; }));
    CHECK(seat.sees("wave.timeline.toml"));
    CHECK_FALSE(seat.has_asked(flow::Request::grab));
    REQUIRE(seat.press("Shaping", [&] { return seat.has_asked(flow::Request::grab); }));
    CHECK(seat.comes([&] { return seat.sees("ball.ply"); }));
  }

  TEST_CASE("edits outlive a new recording and the run") {
    Seat seat;
    seat.edit(seat.timeline_file());
    const edit::EditSession* const session = seat.timeline.session();
    seat.recorded = seat.timeline_file("next.timeline.toml");
    CHECK(seat.comes([&] { return seat.sees("Recorded in"); }));
    CHECK(seat.timeline.session() == session);
    seat.press("undo edit", [] { return true; });
    seat.show(5);
    CHECK(seat.timeline.is_modified()); // no key reaches the timeline behind a dialog
    REQUIRE(seat.press("Close", [&] { return !seat.sees("Recorded in"); }));
    REQUIRE(seat.press("Start", [&] { return seat.has_asked(flow::EndRun{}); }));
    CHECK(std::holds_alternative<Go>(seat.run->left_for()));
    seat.run.reset();
    CHECK(seat.timeline.has_edits_to_lose());
    seat.recorded.clear();
    seat.begin();
    REQUIRE(seat.press("Timeline", [&] { return seat.has_asked(flow::Request::release); }));
    CHECK(seat.timeline.session() == session);
    CHECK(seat.sees("wave.timeline.toml *"));
  }

  TEST_CASE("a file that is opened while a recording ends is not replaced by it") {
    Seat seat;
    const std::string file = seat.timeline_file();
    seat.facts.recorded = true;
    const auto is_asked = [&] { return seat.has_asked(flow::SetRecording{false}); };
    REQUIRE(seat.press("Timeline", is_asked));
    seat.open(file, [&] { return seat.timeline.session() != nullptr; });
    seat.facts.recorded = false;
    seat.recorded = seat.timeline_file("next.timeline.toml");
    CHECK(seat.comes([&] { return seat.sees("Recorded in"); }));
    CHECK(seat.timeline.title() == "wave.timeline.toml");
    seat.facts.recorded = true;
    seat.show();
    seat.facts.recorded = false;
    seat.recorded = seat.timeline_file("last.timeline.toml");
    CHECK(seat.comes([&] { return seat.timeline.title() == "last.timeline.toml"; }));
  }

  TEST_CASE("a file that would replace unsaved edits is opened only if the user wants it") {
    Seat seat;
    seat.edit(seat.timeline_file());
    const edit::EditSession* const session = seat.timeline.session();
    const auto is_asking = [&] { return seat.timeline.is_asking(); };
    const auto has_asked = [&] { return !seat.timeline.is_asking(); };
    seat.send("sent.timeline.toml");
    REQUIRE(seat.comes(is_asking));
    CHECK(std::filesystem::exists("sent.timeline.toml"));
    REQUIRE(seat.press("Stay", has_asked));
    CHECK_FALSE(std::filesystem::exists("sent.timeline.toml"));
    CHECK(seat.timeline.session() == session);
    seat.send("sent.timeline.toml");
    REQUIRE(seat.comes(is_asking));
    REQUIRE(seat.press("Discard", has_asked));
    CHECK(seat.comes([&] { return !seat.timeline.is_open(); })); // it is no timeline
    CHECK_FALSE(std::filesystem::exists("sent.timeline.toml"));
    CHECK_FALSE(seat.has_asked(flow::EndRun{}));
  }

  TEST_CASE("a timeline is opened beside the run by its name, and no file that is not there") {
    Seat seat;
    const std::string file = seat.timeline_file();
    REQUIRE(seat.press("Timeline", [&] { return seat.has_asked(flow::Request::release); }));
    seat.open("/etc/passwd", [&] { return seat.sees("the studio opens no such file"); });
    CHECK_FALSE(seat.timeline.is_open());
    REQUIRE(seat.press("Close", [&] { return !seat.sees("no such file"); }));
    seat.open(file, [&] { return seat.timeline.session() != nullptr; });
    CHECK_FALSE(seat.has_asked(flow::EndRun{}));
  }
}

} // namespace page_run_test
