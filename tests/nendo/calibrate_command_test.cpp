// nendo calibrate, as a wearer uses it: from a capture of the poses, and at a terminal.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <span>
#include <string>

#include <doctest/doctest.h>

#include <nendo/hand/calibration_file.hpp>
#include <nendo/hand/calibration_store.hpp>

#include "calibrate/capture_file.hpp"
#include "gloves/glove_json.hpp"
#include "reference/wearers.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"
#include "support/terminal_program.hpp"

namespace calibrate_command_test {

using namespace nendo;
using namespace nendo::test;

namespace {

constexpr double rate_hz = 90.0;
constexpr int samples_between = 40; ///< from pose to pose
constexpr int samples_held = 270;   // three seconds

/// What precedes the poses, and what has become of the glove.
struct Before {
  double free_motion_s = 0.0;
  std::uint64_t free_motion_seed = 1;
  int slip_counts = 0; ///< of slots with even numbers; the others slip the other way
  SensorMask stuck{};  ///< at 255
};

/// A wearer doing the poses one after another, recorded as nendo monitor --json --raw prints it.
void record(reference::Wearer& wearer, std::span<const hand::PoseId> poses,
            const std::filesystem::path& path, const Before& before = {}) {
  std::ofstream file(path);
  hand::SensorAngles from = wearer.perform(hand::PoseId::flat);
  double time_s = 100.0;
  const auto put = [&](const hand::SensorAngles& angles) {
    GloveSample sample = wearer.read(angles);
    time_s += 1.0 / rate_hz;
    sample.arrival = HostTime(from_seconds(time_s));
    sample.measured = sample.arrival;
    sample.side = wearer.side();
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      const int slip = slot % 2 == 0 ? before.slip_counts : -before.slip_counts;
      if (sample.present.has(static_cast<Sensor>(slot)))
        sample.raw[slot].value = static_cast<std::uint16_t>(
            std::clamp(static_cast<int>(sample.raw[slot].value) + slip, 0, 255));
      if (before.stuck.has(static_cast<Sensor>(slot))) sample.raw[slot].value = 255;
    }
    file << gloves::sample_json(sample, nullptr) << '\n';
  };
  const reference::FreeMotion free_motion(before.free_motion_seed, wearer.ranges());
  for (int k = 0; k < before.free_motion_s * rate_hz; ++k)
    put(from = free_motion.angles_rad(k / rate_hz));
  for (const auto pose : poses) {
    const hand::SensorAngles to = wearer.perform(pose);
    for (int k = 1; k <= samples_between; ++k) {
      hand::SensorAngles between{};
      for (std::size_t slot = 0; slot < sensor_slots; ++slot)
        between[slot] = from[slot] + (to[slot] - from[slot]) * k / samples_between;
      put(between);
    }
    for (int k = 0; k < samples_held; ++k)
      put(to);
    from = to;
  }
}

} // namespace

TEST_SUITE("calibrate") {
  TEST_CASE("a capture of all poses becomes a calibration that is this wearer's") {
    const TemporaryFolder folder;
    for (const std::uint64_t seed : {2001U, 2002U}) { // a left hand and a right one
      reference::Wearer wearer(seed);
      const auto capture = folder.path() / "capture.jsonl";
      const auto out = folder.path() / "anna.toml";
      const auto picture = folder.path() / "anna.svg";
      record(wearer, hand::full_takes(), capture);
      const auto done = nendo::test::nendo(
          {"calibrate", "--from", capture, "--user", "anna", "--out", out, "--picture", picture});
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      CHECK(done.err == "");
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        const auto sensor = static_cast<Sensor>(slot);
        if (sensors_22.has(sensor)) CHECK(done.out.find(name_of(sensor)) != std::string::npos);
      }
      const auto written = hand::read_calibration(out);
      REQUIRE_MESSAGE(written, written.error().message);
      CHECK(written->user == "anna");
      CHECK(written->side == wearer.side());
      CHECK(written->method == "full");
      for (const Sensor sensor : {Sensor::index_mcp, Sensor::middle_pip, Sensor::ring_pip,
                                  Sensor::little_mcp, Sensor::wrist_pitch}) {
        const double truth = wearer.truth()[sensor].gain_rad_per_count;
        CAPTURE(name_of(sensor));
        CHECK(written->calibration[sensor].gain_rad_per_count ==
              doctest::Approx(truth).epsilon(0.15));
      }
      CHECK(contents(picture).find("anna, " + std::string(name_of(wearer.side())) + " hand, " +
                                   hand::rfc3339(written->made)) != std::string::npos);
      CHECK(contents(picture).find("-0 deg") == std::string::npos);
      CHECK(contents(picture).starts_with("<svg"));
      CHECK(contents(picture).ends_with("</svg>\n"));
    }
  }

  TEST_CASE("of stiff fingers only the flat hand is believed") {
    const TemporaryFolder folder;
    reference::Wearer wearer(2004);
    const auto capture = folder.path() / "capture.jsonl";
    const auto out = folder.path() / "cy.toml";
    record(wearer, hand::full_takes(), capture);
    const auto done = nendo::test::nendo(
        {"calibrate", "--from", capture, "--user", "cy", "--stiff", "thumb,wrist", "--out", out});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto written = hand::read_calibration(out);
    REQUIRE_MESSAGE(written, written.error().message);
    const hand::Calibration usual = hand::default_calibration();
    for (const Sensor sensor : {Sensor::thumb_ip, Sensor::wrist_pitch, Sensor::wrist_yaw}) {
      CAPTURE(name_of(sensor));
      CHECK(written->calibration[sensor].gain_rad_per_count == usual[sensor].gain_rad_per_count);
    }
    CHECK(written->calibration[Sensor::ring_pip].gain_rad_per_count !=
          usual[Sensor::ring_pip].gain_rad_per_count);
    CHECK(done.out.find("gain is the default's") != std::string::npos);
  }

  TEST_CASE("a capture that ends before poses are asked for again is a calibration, and says so") {
    const TemporaryFolder folder;
    reference::Wearer wearer(2007);
    const auto capture = folder.path() / "capture.jsonl";
    record(wearer, hand::full_takes().first(28), capture); // as earlier guides asked for them
    const auto done = nendo::test::nendo(
        {"calibrate", "--from", capture, "--user", "anna", "--out", folder.path() / "anna.toml"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    CHECK(is_one_line_about(done.err, "ends before the pose flat was held again"));
    CHECK(done.out.find("28 poses") != std::string::npos);
  }

  TEST_CASE("a touch-up finds how far sensors have slipped, by poses and by a free motion") {
    const TemporaryFolder folder;
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    reference::Wearer wearer(2006);
    const auto capture = folder.path() / "capture.jsonl";
    record(wearer, hand::full_takes(), capture, {30.0, 1, 0});
    const auto full = nendo::test::nendo({"calibrate", "--from", capture, "--user", "ida"});
    REQUIRE_MESSAGE(full.exit_code == 0, full.err);
    const auto path = hand::own_calibration_path("ida", "", wearer.side());
    REQUIRE(path);
    const auto made = hand::read_calibration(*path);
    REQUIRE_MESSAGE(made, made.error().message);
    constexpr int slip = 6;
    record(wearer, hand::touch_up_poses(), capture, {30.0, 2, slip});
    const auto done =
        nendo::test::nendo({"calibrate", "--from", capture, "--user", "ida", "--touch-up"});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto mended = hand::read_calibration(*path);
    REQUIRE_MESSAGE(mended, mended.error().message);
    CHECK(mended->method == "full, touched up");
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      const auto sensor = static_cast<Sensor>(slot);
      if (!sensors_22.has(sensor) || is_gap(sensor)) continue;
      CAPTURE(name_of(sensor));
      const double found = mended->calibration.sensors[slot].offset_counts -
                           made->calibration.sensors[slot].offset_counts;
      CHECK(mended->calibration.sensors[slot].gain_rad_per_count ==
            made->calibration.sensors[slot].gain_rad_per_count);
      CHECK(std::abs(found - (slot % 2 == 0 ? slip : -slip)) < 4.0);
    }
  }

  TEST_CASE("a touch-up leaves out a sensor that broke, and the next one leaves it out as well") {
    const TemporaryFolder folder;
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    reference::Wearer wearer(2006);
    const auto capture = folder.path() / "capture.jsonl";
    record(wearer, hand::quick_poses(), capture);
    const auto quick =
        nendo::test::nendo({"calibrate", "--from", capture, "--user", "ida", "--quick"});
    REQUIRE_MESSAGE(quick.exit_code == 0, quick.err);
    const auto path = hand::own_calibration_path("ida", "", wearer.side());
    REQUIRE(path);
    const SensorMask broken = mask_of(std::array{Sensor::index_pip});
    for (const SensorMask stuck : {broken, SensorMask{}}) { // the second time it moves again
      record(wearer, hand::touch_up_poses(), capture, {30.0, 2, 0, stuck});
      const auto done =
          nendo::test::nendo({"calibrate", "--from", capture, "--user", "ida", "--touch-up"});
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const auto mended = hand::read_calibration(*path);
      REQUIRE_MESSAGE(mended, mended.error().message);
      CHECK(mended->left_out == broken);
      CHECK(mended->calibration[Sensor::index_pip].gain_rad_per_count == 0.0);
      CHECK(mended->calibration[Sensor::ring_pip].gain_rad_per_count != 0.0);
    }
  }

  TEST_CASE("two poses are enough for the quick way, and less is an error that names what lacks") {
    const TemporaryFolder folder;
    reference::Wearer wearer(2003);
    const auto capture = folder.path() / "capture.jsonl";
    const auto out = folder.path() / "quick.toml";
    record(wearer, hand::quick_poses(), capture);
    const auto quick = nendo::test::nendo(
        {"calibrate", "--from", capture, "--user", "bo", "--quick", "--out", out});
    REQUIRE_MESSAGE(quick.exit_code == 0, quick.err);
    CHECK(hand::read_calibration(out)->method == "quick");

    const auto before = contents(out);
    record(wearer, hand::quick_poses().first(1), capture);
    const auto flat_only = nendo::test::nendo(
        {"calibrate", "--from", capture, "--user", "bo", "--quick", "--out", out});
    CHECK(flat_only.exit_code == 5);
    CHECK(flat_only.err.find("fist") != std::string::npos);
    CHECK(contents(out) == before);
  }

  TEST_CASE("held poses can be a capture, too, and are what was held") {
    const TemporaryFolder folder;
    reference::Wearer wearer(2004);
    std::vector<hand::PoseReading> readings;
    for (const auto pose : hand::full_poses()) {
      const GloveSample sample = wearer.read(wearer.perform(pose));
      hand::PoseReading reading{pose, {}};
      reading.held.present = sample.present;
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        reading.held.mean_counts[slot] = sample.raw[slot].value + 0.125;
        reading.held.noise_counts[slot] = 0.5;
      }
      readings.push_back(reading);
    }
    const auto path = folder.path() / "poses.jsonl";
    hand::CountRanges motion;
    motion.present = sensors_22;
    motion.low_counts.fill(12.25);
    motion.high_counts.fill(201.5);
    REQUIRE(calibrate::write_readings(path, readings, motion, wearer.side(), {}));
    const auto read = calibrate::read_capture(path);
    REQUIRE_MESSAGE(read, read.error().message);
    CHECK(read->side == wearer.side());
    CHECK(read->free_motion.present == sensors_22);
    for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
      if (!sensors_22.has(static_cast<Sensor>(slot))) continue;
      CHECK(read->free_motion.low_counts[slot] == 12.25);
      CHECK(read->free_motion.high_counts[slot] == 201.5);
    }
    REQUIRE(read->readings.size() == readings.size());
    for (std::size_t k = 0; k < readings.size(); ++k) {
      CHECK(read->readings[k].pose == readings[k].pose);
      CHECK(read->readings[k].held.present == readings[k].held.present);
      for (std::size_t slot = 0; slot < sensor_slots; ++slot)
        if (readings[k].held.present.has(static_cast<Sensor>(slot)))
          CHECK(read->readings[k].held.mean_counts[slot] == readings[k].held.mean_counts[slot]);
    }
  }

  TEST_CASE("a session that continues has the free motion of the one that was quit") {
    const TemporaryFolder folder;
    reference::Wearer wearer(2005);
    std::vector<hand::PoseReading> readings;
    for (const auto pose : hand::full_poses()) {
      const GloveSample sample = wearer.read(wearer.perform(pose));
      hand::PoseReading reading{pose, {}};
      reading.held.present = sample.present;
      for (std::size_t slot = 0; slot < sensor_slots; ++slot)
        reading.held.mean_counts[slot] = sample.raw[slot].value;
      readings.push_back(reading);
    }
    hand::SensorAngles ends{};
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      ends[slot] = wearer.ranges()[slot].high_rad;
    const GloveSample bent = wearer.read(ends);
    hand::CountRanges motion;
    motion.present = sensors_22;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      motion.high_counts[slot] = bent.raw[slot].value;
    const auto gain_with = [&](const hand::CountRanges& free_motion) {
      const auto path = folder.path() / "unfinished.jsonl", out = folder.path() / "eve.toml";
      REQUIRE(calibrate::write_readings(path, readings, free_motion, wearer.side(), {}));
      const auto done =
          nendo::test::nendo({"calibrate", "--from", path, "--user", "eve", "--out", out});
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      const auto written = hand::read_calibration(out);
      REQUIRE(written);
      return written->calibration[Sensor::thumb_mcp].gain_rad_per_count;
    };
    CHECK(gain_with(motion) != gain_with({}));
  }

  TEST_CASE("what cannot be a calibration is one line about it, with the right exit code") {
    const TemporaryFolder folder;
    const auto refused = [](std::vector<std::string> arguments, int code, const std::string& word) {
      arguments.insert(arguments.begin(), "calibrate");
      const auto done = nendo::test::nendo(arguments);
      CAPTURE(done.err);
      CHECK(done.exit_code == code);
      CHECK(is_one_line_about(done.err, word));
    };
    refused({"--user", "a"}, 2, "GLOVE");
    refused({"sim", "--from", "x", "--user", "a"}, 2, "GLOVE");
    refused({"sim"}, 2, "--user");
    refused({"sim", "--user", "a"}, 2, "terminal");
    refused({"--from", "x", "--view"}, 2, "--view");
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    refused({"sim", "--view"}, 1, "--view");
    refused({"--from", "x", "--user", "a", "--hand-length", "0.19"}, 2, "--hand-length");
    refused({"--from", "x", "--user", "a", "--hand-breadth", "nan"}, 2, "--hand-breadth");
    refused({"--from", "x", "--user", "a", "--stiff", "thumb,toe"}, 2, "--stiff thumb,toe");
    refused({"--from", "x", "--user", "a", "--stiff", "thumb,,index"}, 2, "--stiff thumb,,index");
    const std::string missing = folder.path() / "missing";
    refused({"--from", missing, "--user", "a"}, 5, missing);
    const auto file = folder.path() / "bad.jsonl";
    for (const std::string text :
         {"", "[1]\n", "{\"hand\":\"right\"}\n", "nonsense\n",
          "{\"hand\":\"right\",\"measured_s\":1,\"raw\":{\"index_mcp\":70000}}\n",
          "{\"hand\":\"right\",\"measured_s\":1,\"raw\":{\"elbow\":7}}\n",
          "{\"hand\":\"right\",\"measured_s\":-1e300,\"raw\":{\"index_mcp\":7}}\n",
          "{\"hand\":\"right\",\"pose\":\"flat\",\"counts_most\":0}\n",
          "{\"hand\":\"right\",\"pose\":7,\"counts_most\":255}\n",
          "{\"hand\":\"right\",\"low_counts\":{\"index_mcp\":7},\"counts_most\":255}\n",
          "{\"hand\":\"right\",\"low_counts\":{\"index_mcp\":7},\"high_counts\":{\"ring_mcp\":9},"
          "\"counts_most\":255}\n",
          "{\"hand\":\"right\",\"low_counts\":{\"index_mcp\":7},\"high_counts\":{\"index_mcp\":300}"
          ","
          "\"counts_most\":255}\n"}) {
      write_file(file, text);
      refused({"--from", file, "--user", "a"}, 5, "bad.jsonl");
    }
  }

  TEST_CASE("a session that was quit and cannot be read can be left behind") {
    const TemporaryFolder folder;
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    const auto stored = folder.path() / "nendo" / "calibrations";
    std::filesystem::create_directories(stored);
    const auto file = hand::calibration_file_name("dora", "", Side::right) + ".unfinished";
    write_file(stored / file, "nonsense\n");
    TerminalProgram refused({"calibrate", "sim", "--user", "dora"}, 200, 26);
    REQUIRE(refused.prints("--fresh"));
    CHECK(refused.wait() == 5);
    TerminalProgram fresh({"calibrate", "sim", "--user", "dora", "--fresh"}, 100, 26);
    REQUIRE(fresh.shows("Pose 1 of"));
    REQUIRE(fresh.press('q'));
    CHECK(fresh.wait() == 0);
  }

  TEST_CASE("two poses that contradict each other can be taken again, and be left behind") {
    const TemporaryFolder folder;
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    const auto stored = folder.path() / "nendo" / "calibrations";
    std::filesystem::create_directories(stored);
    const auto written = stored / hand::calibration_file_name("fay", "", Side::right);
    const std::filesystem::path file = written.string() + ".unfinished";
    // As an earlier program kept them: a fist that is the flat hand.
    hand::HeldPose flat;
    flat.present = sensors_22;
    flat.mean_counts.fill(100.0);
    const std::vector<hand::PoseReading> same{{hand::PoseId::flat, flat},
                                              {hand::PoseId::fist, flat}};
    REQUIRE(calibrate::write_readings(file, same, {}, Side::right, {}));
    const std::vector<std::string> again{"calibrate", "sim:wave", "--user", "fay", "--quick"};
    {
      TerminalProgram program(again, 200, 26);
      for (const char* word : {"Pose 2 of 2", "No calibration yet", "contradict", "n restarts"}) {
        CAPTURE(word);
        REQUIRE(program.shows(word));
      }
      REQUIRE(program.press('w')); // with a pose missing it is no end
      REQUIRE(program.shows("fist is missing"));
      REQUIRE(program.press('q'));
      CHECK(program.wait() == 0);
      CHECK(program.screen().transcript().find("1 pose is kept") != std::string::npos);
    }
    const auto kept = calibrate::read_capture(file);
    REQUIRE(kept);
    CHECK(kept->readings.size() == 1);
    {
      TerminalProgram program(again, 100, 26);
      REQUIRE(program.shows("Pose 2 of 2"));
      REQUIRE(program.press('n'));
      REQUIRE(program.shows("n once more"));
      REQUIRE(program.press(' ')); // something else was meant
      REQUIRE(program.shows([](const VtScreen& screen) { return !screen.shows("n once more"); }));
      CHECK(program.screen().shows("Pose 2 of 2"));
      REQUIRE(program.press('n'));
      REQUIRE(program.shows("n once more"));
      REQUIRE(program.press('n'));
      REQUIRE(program.shows("Pose 1 of 2"));
      REQUIRE(program.shows("SPACE begins"));
      REQUIRE(program.press('q'));
      CHECK(program.wait() == 0);
    }
    CHECK_FALSE(std::filesystem::exists(file));
    CHECK_FALSE(std::filesystem::exists(written));
  }

  TEST_CASE("w with a pose missing continues, and says which") {
    const TemporaryFolder folder;
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    TerminalProgram program({"calibrate", "sim:wave", "--user", "gus"}, 40, 26);
    REQUIRE(program.shows("Pose 1 of"));
    REQUIRE(program.press('w'));
    for (const char* word : {"No calibration yet", "the pose flat is", "Pose 1 of"}) {
      CAPTURE(word);
      REQUIRE(program.shows(word));
    }
    REQUIRE(program.press('q'));
    CHECK(program.wait() == 0);
  }

  TEST_CASE(
      "at a terminal the pose is drawn, a moving hand is asked to hold still, and q gives the "
      "terminal back") {
    const TemporaryFolder folder;
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    TerminalProgram program({"calibrate", "sim:wave", "--user", "cleo"}, 100, 26);
    // A picture may arrive in parts: each word is waited for.
    for (const char* word : {"Pose 1 of", "cleo", "SPACE begins", "q quit"}) {
      CAPTURE(word);
      REQUIRE(program.shows(word));
    }
    REQUIRE(program.press(' '));
    REQUIRE(program.shows("Hold still"));
    REQUIRE(program.press('s')); // flat is skipped for now
    REQUIRE(program.shows("Pose 2 of"));
    REQUIRE(program.press('b'));
    REQUIRE(program.shows("Pose 1 of"));
    REQUIRE(program.press('q'));
    CHECK(program.wait() == 0);
    CHECK_FALSE(program.screen().on_page());
  }
}

} // namespace calibrate_command_test
