// The commands that look at devices, with trackers: info, monitor, doctor, record, run.

#include <cmath>
#include <csignal>
#include <set>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include "support/json_lines.hpp"
#include "support/program.hpp"
#include "support/terminal_program.hpp"

namespace tracker_command_test {

using nendo::test::is_one_line_about;
using nendo::test::lines_of;
using nendo::test::TemporaryFolder;
using nendo::test::TerminalProgram;
using nendo::test::VtScreen;
using nlohmann::json;

namespace {

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

} // namespace

TEST_SUITE("tracker commands") {
  TEST_CASE("info says what the tracker is, by its motion or by --tracker") {
    for (const std::vector<std::string>& arguments :
         {std::vector<std::string>{"info", "sim:orbit?station=2&rate=60"},
          {"info", "sim:rest?station=2&rate=60", "--tracker"}}) {
      const auto text = nendo::test::nendo(arguments);
      CAPTURE(text.err);
      REQUIRE(text.exit_code == 0);
      CHECK(contains(text.out, "stations    2\n"));
      CHECK(contains(text.out, "rate        60 Hz\n"));
      CHECK(contains(text.out, "axes        x away from the operator, y to the right, z down\n"));
      for (const auto& line : lines_of(text.out))
        CHECK(line.size() <= 80);
      auto with_json = arguments;
      with_json.emplace_back("--json");
      const json info = last_object(nendo::test::nendo(with_json));
      CHECK(contains(info["source"], "sim:"));
      CHECK(contains(info["model"], "simulated tracker"));
      CHECK(info["stations"] == json{2});
      CHECK(info["rate_hz"] == 60.0);
      CHECK(info["filtered"] == false);
      CHECK(info["stage_from_tracker_xyzw"] == json{0.5, 0.5, -0.5, 0.5});
      CHECK(info["facts"].is_object());
    }
    CHECK(contains(nendo::test::nendo({"info", "sim:rest"}).out, "sensors     22\n"));
  }

  TEST_CASE("monitor prints one JSON object a pose, of as many stations as are named") {
    const auto done = nendo::test::nendo(
        {"monitor", "sim:orbit?station=1", "sim:orbit?station=2", "--count", "60"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    CHECK(contains(done.err, " delivered"));
    const auto lines = lines_of(done.out);
    REQUIRE(lines.size() == 60);
    std::set<int> stations;
    for (const auto& text : lines) {
      const json line = json::parse(text);
      stations.insert(line["station"].get<int>());
      CHECK(line["source"] == "sim:orbit?station=" + std::to_string(line["station"].get<int>()));
      REQUIRE(line["position_m"].size() == 3);
      REQUIRE(line["turn_xyzw"].size() == 4);
      double length = 0.0;
      for (const double part : line["turn_xyzw"])
        length += part * part;
      CHECK(length == doctest::Approx(1.0));
      for (const auto* key : {"time_s", "measured_s", "device_time_s", "azimuth_deg",
                              "elevation_deg", "roll_deg", "sequence"})
        CHECK(line[key].is_number());
      CHECK(line["error"].is_null());
    }
    CHECK(stations == std::set{1, 2});
  }

  TEST_CASE("monitor ends after its duration, with gloves as with trackers") {
    for (const std::string device : {"sim:orbit", "sim:wave"}) {
      const auto done = nendo::test::nendo({"monitor", device, "--json", "--duration", "300ms"});
      CHECK(done.exit_code == 0);
      CHECK(lines_of(done.out).size() > 2);
      CHECK(done.seconds >= 0.3);
    }
  }

  TEST_CASE("in a terminal there is a line a station, which fits 80 characters, until q") {
    TerminalProgram program({"monitor", "sim:orbit?station=1", "sim:orbit?station=2"}, 80, 24);
    REQUIRE(program.shows("elevation"));
    REQUIRE(program.shows([](const VtScreen& screen) {
      const std::string line = screen.line_of("      2 ");
      return line.find_last_not_of(' ') == 78 && line[78] == '-';
    }));
    CHECK(program.screen().shows("q quit"));
    CHECK(program.screen().faults().empty());
    CHECK(program.press('q'));
    CHECK(program.wait() == 0);
    CHECK(program.is_restored());
    CHECK(contains(program.screen().transcript(), "elevation")); // it stays
  }

  TEST_CASE("doctor looks at a second of poses") {
    const auto done = nendo::test::nendo({"doctor", "sim:orbit"});
    CAPTURE(done.out);
    CHECK(contains(done.out, "sim:orbit ("));
    CHECK(contains(done.out, " 0 refused"));
    CHECK(contains(done.out, " mm from its origin)"));
    CHECK_FALSE(contains(done.out, "failure: sim:orbit"));
  }

  TEST_CASE("record keeps the poses of wrists, and the recording is a tracker") {
    const TemporaryFolder folder;
    const std::string take = (folder.path() / "take.nendo").string();
    const auto done = nendo::test::nendo(
        {"record", "sim:wave?hand=left", "sim:wave", "--left-wrist", "sim:orbit?station=1",
         "--right-wrist", "sim:orbit?station=2", "--out", take, "--duration", "1s", "--json"});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json recorded = last_object(done);
    REQUIRE(recorded["wrists"].size() == 2);
    CHECK(recorded["wrists"][1]["hand"] == "right");
    CHECK(recorded["wrists"][1]["station"] == 2);
    const int left = recorded["wrists"][0]["poses"];
    const int both = left + recorded["wrists"][1]["poses"].get<int>();
    CHECK(left > 20);

    const auto report = nendo::test::nendo({"recording", "info", take, "--json"});
    const json info = last_object(report);
    CHECK(info["whole"] == true);
    CHECK(info["gaps"] == 0);
    CHECK(info["poses"] == both);
    REQUIRE(info["trackers"].size() == 2);
    CHECK(info["trackers"][0]["hand"] == "left");
    CHECK(info["trackers"][0]["source"] == "sim:orbit?station=1");
    CHECK(info["trackers"][1]["source"] == "sim:orbit?station=2");
    CHECK(contains(nendo::test::nendo({"recording", "info", take}).out, "left wrist"));
    CHECK(nendo::test::nendo({"recording", "check", take}).exit_code == 0);

    const std::string replay = "replay:" + take + "?hand=left&speed=2";
    CHECK(last_object(nendo::test::nendo({"info", replay, "--tracker", "--json"}))["rate_hz"] ==
          480.0);
    const auto seen = nendo::test::nendo({"monitor", replay, "--tracker"});
    CHECK(seen.exit_code == 0);
    CHECK(static_cast<int>(lines_of(seen.out).size()) == left);
    CHECK(last_object(seen)["replayed_s"].is_number());
    CHECK(contains(seen.err, " 0 missed"));
    CHECK(nendo::test::nendo({"doctor", replay, "--tracker"}).out.find("0 refused") !=
          std::string::npos);
    const auto glove = nendo::test::nendo({"monitor", replay, "--count", "1"});
    CHECK(last_object(glove)["hand"] == "left");
  }

  TEST_CASE("the tracker of a recording names the hand and the station that it has") {
    const TemporaryFolder folder;
    const std::string take = (folder.path() / "take.nendo").string();
    REQUIRE(nendo::test::nendo({"record", "sim:wave", "--right-wrist", "sim:orbit?station=3",
                                "--out", take, "--duration", "500ms"})
                .exit_code == 0);
    const std::string replay = "replay:" + take;
    const auto seen = nendo::test::nendo({"monitor", replay, "--tracker", "--count", "1"});
    CAPTURE(seen.err);
    REQUIRE(seen.exit_code == 0);
    CHECK(last_object(seen)["source"] == replay + "?hand=right");
    CHECK(last_object(seen)["station"] == 3);
    const auto again =
        nendo::test::nendo({"record", "sim:wave", "--right-wrist", replay, "--out",
                            (folder.path() / "again.nendo").string(), "--duration", "500ms"});
    CAPTURE(again.err);
    CHECK(contains(again.out, " poses; " + replay + "?hand=right\n"));
    CHECK(is_one_line_about(nendo::test::nendo({"info", replay + "?hand=left", "--tracker"}).err,
                            "left hand"));
  }

  TEST_CASE("record without a tracker has no wrists, and refuses a tracker for no hand") {
    const TemporaryFolder folder;
    const std::string take = (folder.path() / "take.nendo").string();
    const auto none = nendo::test::nendo(
        {"record", "sim", "--left-wrist", "sim:orbit", "--out", take, "--duration", "1s"});
    CHECK(none.exit_code == 2);
    CHECK(is_one_line_about(none.err, "there is no left hand"));
    const auto done =
        nendo::test::nendo({"record", "sim", "--out", take, "--duration", "200ms", "--json"});
    CHECK(last_object(done)["wrists"].empty());
    const auto replayed = nendo::test::nendo({"info", "replay:" + take, "--tracker"});
    CHECK(replayed.exit_code != 0);
    CHECK(is_one_line_about(replayed.err, "no tracker moved a hand"));
  }

  TEST_CASE("the summary of a run has the poses of each wrist, and how late they are shown") {
    const TemporaryFolder folder;
    const std::string out = (folder.path() / "shape.obj").string();
    std::vector<std::string> arguments{"run",
                                       "--left",
                                       "sim:wave",
                                       "--right",
                                       "sim:wave",
                                       "--left-wrist",
                                       "sim:orbit",
                                       "--right-wrist",
                                       "sim:orbit?station=2",
                                       "--duration",
                                       "2",
                                       "--out",
                                       out};
    const auto text = nendo::test::nendo(arguments);
    CAPTURE(text.err);
    REQUIRE(text.exit_code == 0);
    CHECK(contains(text.out, "  right wrist    "));
    CHECK(contains(text.out, "; sim:orbit?station=1\n"));
    CHECK(contains(text.out, "; sim:orbit?station=2\n"));
    CHECK(contains(text.out, "  pose to frame  p50 "));
    CHECK(contains(text.out, "  age of poses   p50 "));
    CHECK_FALSE(contains(text.out, "hemisphere"));
    arguments.emplace_back("--json");
    const auto done = nendo::test::nendo(arguments);
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    const json summary = last_object(done);
    for (const std::string side : {"left", "right"}) {
      const json& wrist = summary[side]["wrist"];
      const int station = side == "left" ? 1 : 2;
      CHECK(wrist["tracker"] == "sim:orbit?station=" + std::to_string(station));
      CHECK(wrist["station"] == station);
      CHECK(wrist["poses"].get<int>() > 50);
      CHECK(wrist["poses"].get<int>() <= wrist["delivered"].get<int>());
      for (const auto* none : {"flips", "releases"})
        CHECK(wrist[none] == 0);
      CHECK(wrist["lost"] == false);
      const json progress = json::parse(lines_of(done.out).front())[side];
      CHECK(progress["wrist_lost"].is_boolean());
      CHECK(progress["poses"].get<int>() <= wrist["poses"].get<int>());
      CHECK(progress["refused_poses"].get<int>() <= wrist["refused_poses"].get<int>());
    }
    CHECK(summary["pose_to_frame_ms"]["count"].get<int>() > 50);
    CHECK(summary["pose_age_ms"]["p50"].get<double>() >=
          summary["pose_to_frame_ms"]["min"].get<double>());
  }

  TEST_CASE("a run reports a wrist that its tracker loses, and ends with it in the summary") {
    const TemporaryFolder folder;
    const std::string take = (folder.path() / "take.nendo").string();
    REQUIRE(nendo::test::nendo({"record", "sim:wave?hand=left", "--left-wrist", "sim:orbit",
                                "--out", take, "--duration", "300ms"})
                .exit_code == 0);
    const auto done =
        nendo::test::nendo({"run", "--left", "sim:wave", "--left-wrist", "replay:" + take,
                            "--duration", "3", "--out", (folder.path() / "shape.obj").string()});
    CAPTURE(done.err);
    REQUIRE(done.exit_code == 0);
    CHECK(
        contains(done.err, "replay:" + take + "?hand=left: no good pose of the left wrist comes"));
    CHECK(contains(done.err, "wrist lost"));
    CHECK_FALSE(contains(done.out, " 0 losses"));
    CHECK(contains(done.out, "lost at the end"));
    CHECK_FALSE(contains(nendo::test::nendo({"run", "--left", "sim:wave", "--duration", "1",
                                             "--out", (folder.path() / "b.obj").string()})
                             .out,
                         "wrist "));
  }

  TEST_CASE("a wrong tracker gets one clear line and the right exit code") {
    for (const std::string command : {"info", "monitor", "doctor"}) {
      const auto unknown = nendo::test::nendo({command, "bogus:1", "--tracker"});
      CHECK(unknown.exit_code == 2);
      CHECK(is_one_line_about(unknown.err, "tracker \"bogus:1\": unknown kind bogus"));
      const auto motion = nendo::test::nendo({command, "sim:sculpt", "--tracker"});
      CHECK(motion.exit_code == 2);
      CHECK(is_one_line_about(motion.err, "orbit"));
      const auto rate = nendo::test::nendo({command, "sim:orbit?rate=0"});
      CHECK(rate.exit_code == 2);
      CHECK(is_one_line_about(rate.err, "option rate"));
    }
    const auto mixed = nendo::test::nendo({"monitor", "sim:orbit", "sim:sculpt"});
    CHECK(mixed.exit_code == 2);
    const auto gloves = nendo::test::nendo({"monitor", "sim", "sim"});
    CHECK(gloves.exit_code == 2);
    CHECK(is_one_line_about(gloves.err, "takes one glove, or several trackers"));
  }
}

} // namespace tracker_command_test
