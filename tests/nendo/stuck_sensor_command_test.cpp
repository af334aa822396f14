// What people see of a sensor that is stuck: in info, doctor, monitor, poses, run and
// calibrate.

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include <doctest/doctest.h>
#include <nlohmann/json.hpp>

#include <nendo/hand/calibration_file.hpp>

#include "gloves/glove_json.hpp"
#include "reference/wearers.hpp"
#include "support/program.hpp"
#include "support/terminal_program.hpp"

namespace stuck_sensor_command_test {

using namespace nendo;
using namespace nendo::test;
using nlohmann::json;

namespace {

/// An emulated glove of a hand that opens and closes, with these faults.
struct FaultyGlove {
  TemporaryFolder folder;
  std::string link = (folder.path() / "glove").string();
  Program emulator;

  explicit FaultyGlove(const std::vector<std::string>& faults, const std::string& motion = "grasp",
                       const std::vector<std::string>& more = {})
      : emulator(arguments(faults, motion, more)) {
    appears(link);
  }
  std::string spec() const { return "serial:" + link; }

private:
  std::vector<std::string> arguments(const std::vector<std::string>& faults,
                                     const std::string& motion,
                                     const std::vector<std::string>& more) const {
    std::vector<std::string> all{"emulate", "--link", link, "--motion", motion};
    for (const std::string& fault : faults) {
      all.emplace_back("--fault");
      all.push_back(fault);
    }
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
};

std::size_t count_of(const std::string& text, const std::string& what) {
  std::size_t count = 0;
  for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + 1))
    ++count;
  return count;
}

/// A free motion and held poses, as nendo monitor --json --raw prints them, with sensors that stand
/// still from a time of the capture on.
void capture_poses(const std::filesystem::path& path, std::uint64_t seed,
                   const std::vector<std::pair<Sensor, std::uint16_t>>& stuck, double from_s) {
  std::ofstream file(path);
  reference::Wearer wearer(seed);
  double time_s = 0.0;
  const auto put = [&](const hand::SensorAngles& angles) {
    GloveSample sample = wearer.read(angles);
    time_s += 1.0 / 90.0;
    sample.arrival = sample.measured = HostTime(from_seconds(100.0 + time_s));
    sample.side = wearer.side();
    for (const auto& [sensor, count] : stuck)
      if (time_s >= from_s) sample.raw[static_cast<std::size_t>(sensor)].value = count;
    file << gloves::sample_json(sample, nullptr) << '\n';
  };
  const reference::FreeMotion motion(3, wearer.ranges());
  hand::SensorAngles from{};
  for (int n = 0; n < 12 * 90; ++n)
    put(from = motion.angles_rad(n / 90.0));
  for (const auto pose : hand::full_takes()) {
    const hand::SensorAngles to = wearer.perform(pose);
    for (int k = 1; k <= 40; ++k) {
      hand::SensorAngles between{};
      for (std::size_t slot = 0; slot < sensor_slots; ++slot)
        between[slot] = from[slot] + (to[slot] - from[slot]) * k / 40;
      put(between);
    }
    for (int k = 0; k < 270; ++k)
      put(to);
    from = to;
  }
}

} // namespace

TEST_SUITE("stuck_sensor_command") {
  TEST_CASE("info and doctor name a sensor that stands at its end, and only such a one") {
    const FaultyGlove glove({"stick@0s=index_pip:255", "stick@0s=ring_mcp:130"});
    // On a busy machine an emulated glove may send nothing for the two seconds that info waits.
    auto report = nendo::test::nendo({"info", glove.spec()});
    for (int again = 0;
         again < 2 && report.out.find("at the end of its range") == std::string::npos; ++again)
      report = nendo::test::nendo({"info", glove.spec()});
    REQUIRE_MESSAGE(report.exit_code == 0, report.err);
    CHECK(report.out.find("index_pip is at the end of its range (255)") != std::string::npos);
    CHECK(report.out.find("ring_mcp is at") == std::string::npos); // at rest nobody can know
    for (const auto& line : lines_of(report.out))
      if (line.find("at the end") != std::string::npos) CHECK(line.size() <= 80);
    json at_end;
    for (int again = 0; again < 3 && at_end.empty(); ++again) {
      const auto as_json = nendo::test::nendo({"info", glove.spec(), "--json"});
      REQUIRE(as_json.exit_code == 0);
      at_end = json::parse(as_json.out)["at_end"];
    }
    CHECK(at_end == json{{"index_pip", 255}});
    const auto doctor = nendo::test::nendo({"doctor", glove.spec(), "--json"});
    CHECK(doctor.out.find("index_pip is at the end of its range (255)") != std::string::npos);
    const FaultyGlove whole({});
    const auto well = nendo::test::nendo({"info", whole.spec(), "--json"});
    REQUIRE(well.exit_code == 0);
    CHECK(json::parse(well.out)["at_end"].empty());
  }

  TEST_CASE("monitor and poses name a sensor that is stuck once, and mark what is estimated") {
    const FaultyGlove for_monitor({"stick@0s=index_pip:140", "stick@0s=ring_mcp:1"});
    const FaultyGlove for_poses({"stick@0s=index_pip:255"});
    Program monitor({"monitor", for_monitor.spec(), "--json", "--count", "1600"});
    Program poses({"poses", for_poses.spec(), "--count", "1600"});
    const auto seen = monitor.wait();
    REQUIRE_MESSAGE(seen.exit_code == 0, seen.err);
    CHECK(count_of(seen.err, "index_pip stands still at 140") == 1);
    CHECK(count_of(seen.err, "ring_mcp stands still at 1 ") == 1);
    CHECK(count_of(seen.err, "stands still") == 2);
    const auto lines = lines_of(seen.out);
    const json first = json::parse(lines.front()), last = json::parse(lines.back());
    CHECK_FALSE(first.contains("left_out"));
    CHECK(last["left_out"] == json{"index_pip", "ring_mcp"});
    CHECK(last["raw"]["index_pip"] == 140); // what the glove sends stays what it is
    const auto posed = poses.wait();
    REQUIRE_MESSAGE(posed.exit_code == 0, posed.err);
    CHECK(count_of(posed.err, "index_pip stands still at 255") == 1);
    const auto of_poses = lines_of(posed.out);
    CHECK_FALSE(json::parse(of_poses.front())["deviations_deg"].contains("index_pip_flexion"));
    const json pose = json::parse(of_poses.back());
    CHECK(pose["left_out"] == json{"index_pip"});
    CHECK(pose["deviations_deg"]["index_pip_flexion"].get<double>() >= 10.0);
    const auto news = std::count_if(of_poses.begin(), of_poses.end(), [](const std::string& line) {
      return line.find("\"index_pip_flexion\":\"from_neighbours\"") != std::string::npos;
    });
    CHECK(news == 1);
  }

  TEST_CASE("a sensor that fails in a run is left out, comes back, and the replay is the same") {
    std::optional<FaultyGlove> glove;
    const auto at = [&](const std::string& name) { return (glove->folder.path() / name).string(); };
    nendo::test::Finished run;
    for (int again = 0; again < 3 && run.exit_code != 0; ++again) { // as above
      glove.emplace(std::vector<std::string>{"stick@3s+14s=index_pip:255"});
      run = nendo::test::nendo({"run", "--right", glove->spec(), "--duration", "22", "--json",
                                "--out", at("shape.ply"), "--record", at("take.nendo")});
    }
    REQUIRE_MESSAGE(run.exit_code == 0, run.err);
    CHECK(count_of(run.err, "index_pip stands still") == 1);
    CHECK(count_of(run.err, "index_pip moves again") == 1);
    const json summary = json::parse(lines_of(run.out).back());
    CHECK(summary["right"]["left_out"].empty());
    CHECK(summary["right"]["was_left_out"] == json{"index_pip"});
    const auto again =
        nendo::test::nendo({"replay", at("take.nendo"), "--no-clock", "--out", at("again.ply")});
    REQUIRE_MESSAGE(again.exit_code == 0, again.err);
    CHECK(contents(at("shape.ply")) == contents(at("again.ply")));
  }

  TEST_CASE("no simulated hand of a run is taken for one with a stuck sensor") {
    for (const std::string motion : {"sim:pinch", "sim:faces", "sim:press", "sim:touch"}) {
      CAPTURE(motion);
      std::vector<std::string> arguments{"run",  "--left",     motion, "--right",
                                         motion, "--duration", "8",    "--json"};
      if (motion == "sim:press") arguments.insert(arguments.end(), {"--mode", "clay"});
      const auto run = nendo::test::nendo(arguments);
      REQUIRE_MESSAGE(run.exit_code == 0, run.err);
      const json summary = json::parse(lines_of(run.out).back());
      CHECK(summary["left"]["was_left_out"].empty());
      CHECK(summary["right"]["was_left_out"].empty());
    }
  }

  TEST_CASE("a capture with stuck sensors is calibrated without them, and says so in one line") {
    struct Case {
      std::vector<std::pair<Sensor, std::uint16_t>> stuck;
      double from_s;
      std::string words;
    };
    for (const Case& made : {Case{{{Sensor::index_pip, 255}}, 0.0, "index_pip is stuck"},
                             Case{{{Sensor::ring_mcp, 118}}, 0.0, "ring_mcp is stuck"},
                             Case{{{Sensor::index_pip, 1}, {Sensor::wrist_yaw, 128}},
                                  0.0,
                                  "index_pip and wrist_yaw are stuck"},
                             Case{{{Sensor::middle_pip, 90}}, 40.0, "middle_pip is stuck"}}) {
      CAPTURE(made.words);
      const TemporaryFolder folder;
      const auto capture = folder.path() / "capture.jsonl", out = folder.path() / "anna.toml";
      capture_poses(capture, 2004, made.stuck, made.from_s);
      const auto done =
          nendo::test::nendo({"calibrate", "--from", capture, "--user", "anna", "--out", out});
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      CHECK(lines_of(done.err).size() == 1);
      CHECK(done.err.find(made.words) != std::string::npos);
      const auto written = hand::read_calibration(out);
      REQUIRE_MESSAGE(written, (written ? "" : written.error().message));
      SensorMask expected;
      for (const auto& [sensor, count] : made.stuck) {
        expected.add(sensor);
        CHECK(done.out.find(std::string(name_of(sensor)) + "  ") != std::string::npos);
        CHECK(written->calibration[sensor].gain_rad_per_count == 0.0);
      }
      CHECK(written->left_out == expected);
      CHECK(count_of(done.out, "is stuck: left out") == made.stuck.size());
      const auto shown = nendo::test::nendo({"calibration", "show", out});
      CHECK(shown.out.find("left out, because they are stuck: ") != std::string::npos);
    }
  }

  TEST_CASE("a wearer at a terminal is warned about a stuck sensor, and continues without it") {
    const FaultyGlove glove({"stick@0s=index_pip:255"}, "poses", {"--hold", "3s"});
    const TemporaryFolder folder;
    TerminalProgram calibrate({"calibrate", glove.spec(), "--user", "anna", "--quick", "--out",
                               (folder.path() / "anna.toml").string()},
                              130, 40);
    REQUIRE(calibrate.shows("Then SPACE begins"));
    std::this_thread::sleep_for(std::chrono::seconds(6));
    calibrate.press(' ');
    REQUIRE(calibrate.shows("index_pip is stuck"));
    CHECK(calibrate.wait() == 0);
    CHECK(calibrate.is_restored());
    const auto written = hand::read_calibration(folder.path() / "anna.toml");
    REQUIRE_MESSAGE(written, (written ? "" : written.error().message));
    CHECK(written->left_out.has(Sensor::index_pip));
  }

  TEST_CASE("the poses can be practised by SPACE in the terminal that emulates") {
    const TemporaryFolder folder;
    const std::string link = (folder.path() / "glove").string();
    TerminalProgram emulate({"emulate", "--link", link, "--motion", "poses"}, 100, 30);
    REQUIRE(emulate.prints("SPACE"));
    REQUIRE(appears(link));
    TerminalProgram calibrate({"calibrate", "serial:" + link, "--user", "anna", "--quick", "--out",
                               (folder.path() / "anna.toml").string()},
                              130, 40);
    REQUIRE(calibrate.shows("Then SPACE begins"));
    std::this_thread::sleep_for(std::chrono::seconds(4));
    calibrate.press(' ');
    REQUIRE(calibrate.shows("Pose 1 of 2: flat"));
    emulate.press(' ');
    REQUIRE(emulate.prints("pose 1 of 34: flat"));
    REQUIRE(calibrate.shows("Pose 2 of 2: fist"));
    emulate.press(' ');
    CHECK(calibrate.wait() == 0);
    emulate.press('q');
    CHECK(emulate.wait() == 0);
    const auto monitored =
        hand::read_calibration(folder.path() / "anna.toml"); // what monitor --user reads
    REQUIRE(monitored);
    CHECK(monitored->left_out.bits == 0);
  }
}

} // namespace stuck_sensor_command_test
