// nendo calibrate tracker, with a simulated tracker and a simulated glove on one arm that does the
// exercise.

#include <cmath>
#include <cstdlib>
#include <string>

#include <doctest/doctest.h>

#include <nendo/hand/tracker_mount.hpp>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace calibrate_tracker_command_test {

using namespace nendo;
using namespace nendo::test;

namespace {

Finished calibrate(std::vector<std::string> arguments) {
  arguments.insert(arguments.begin(), {"calibrate", "tracker"});
  return nendo::test::nendo(std::move(arguments));
}

/// The simulated station sits 60 mm before the wrist and 25 mm above it (its z points down), and
/// its axes are the tracker's while the forearm points to the front.
void check_mount(const hand::TrackerMount& mount) {
  CHECK(mount.position_mm[0] == doctest::Approx(60.0).epsilon(0.01));
  CHECK(std::abs(mount.position_mm[1]) < 0.5);
  CHECK(mount.position_mm[2] == doctest::Approx(25.0).epsilon(0.02));
  const Eigen::Matrix3d turn =
      Eigen::Quaterniond(mount.stage_from_tracker_xyzw.data()).toRotationMatrix() *
      Eigen::Quaterniond(mount.turn_xyzw.data()).toRotationMatrix();
  CHECK(Eigen::AngleAxisd(turn).angle() < 0.02);
}

} // namespace

TEST_SUITE("calibrate tracker") {
  TEST_CASE("the mount and the time offset are found, said and written where they are found") {
    const TemporaryFolder folder;
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    for (const std::string side : {"left", "right"}) {
      const std::string station = side == "left" ? "1" : "2";
      const auto done = calibrate({"--tracker", "sim:table?station=" + station, "--glove",
                                   "sim:table?hand=" + side, "--duration", "6s"});
      REQUIRE_MESSAGE(done.exit_code == 0, done.err);
      CAPTURE(done.out);
      CHECK(done.err.find("circles with your elbow") != std::string::npos);
      CHECK(done.err.find("begin now") != std::string::npos);
      CHECK(done.out.find("Residual: ") != std::string::npos);
      CHECK(done.out.find("than the glove (uncertain by ") != std::string::npos);
      const auto found = hand::find_mount("sim:table", static_cast<std::uint16_t>(station[0] - '0'),
                                          side == "left" ? Side::left : Side::right);
      REQUIRE_MESSAGE(found, found.error().message);
      REQUIRE(found->has_value());
      check_mount(**found);
      CHECK(std::abs((*found)->late_ms) < 60.0); // the two simulations do not begin at one time
      CHECK((*found)->residual_mm < 0.1);
      CHECK((*found)->tracker == "sim:table");
    }
  }

  TEST_CASE("without a glove there is a mount, and no time offset") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "mounts" / "mount.toml";
    const auto done =
        calibrate({"--tracker", "sim:table", "--side", "right", "--duration", "6s", "--out", out});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    CHECK(done.out.find("time offset is not known") != std::string::npos);
    CHECK(done.out.find("wrote ") != std::string::npos);
    const auto mount = hand::read_mount(out);
    REQUIRE_MESSAGE(mount, mount.error().message);
    CHECK(mount->position_mm[0] == doctest::Approx(60.0).epsilon(0.01));
    CHECK(mount->late_ms == 0.0);
    CHECK(mount->station == 1);
    CHECK(mount->side == Side::right);
    CHECK(!mount->on_hand);
  }

  TEST_CASE("a glove that does something else gives no time offset, and the mount is written") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "mount.toml";
    const auto done = calibrate(
        {"--tracker", "sim:table", "--glove", "sim:wave", "--duration", "6s", "--out", out});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    CHECK(done.out.find("does not move as the tracker does") != std::string::npos);
    CHECK(hand::read_mount(out)->late_ms == 0.0);
  }

  TEST_CASE("a station on a still hand has a turn") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "mount.toml";
    const auto done = calibrate({"--tracker", "sim:rest", "--side", "right", "--mounted", "hand",
                                 "--duration", "5s", "--out", out});
    REQUIRE_MESSAGE(done.exit_code == 0, done.err);
    const auto mount = hand::read_mount(out);
    REQUIRE_MESSAGE(mount, mount.error().message);
    CHECK(mount->on_hand);
  }

  TEST_CASE("a bad exercise is refused, says what to do, and leaves the file") {
    const TemporaryFolder folder;
    const auto out = folder.path() / "mount.toml";
    const auto still =
        calibrate({"--tracker", "sim:rest", "--side", "left", "--duration", "5s", "--out", out});
    CHECK(still.exit_code == 5);
    CHECK(still.err.find("draw circles with the elbow") != std::string::npos);
    CHECK(still.out == "");
    CHECK(!std::filesystem::exists(out));
  }

  TEST_CASE("wrong arguments are usage errors, before anything is opened") {
    const auto refused = [](std::vector<std::string> arguments, const char* words) {
      const auto done = calibrate(std::move(arguments));
      CAPTURE(done.err);
      CHECK(done.exit_code == 2);
      CHECK(is_one_line_about(done.err, words));
    };
    refused({"--side", "left"}, "--tracker");
    refused({"--tracker", "sim:table"}, "--side");
    refused({"--tracker", "sim:table", "--side", "both"}, "both");
    refused({"--tracker", "sim:table", "--side", "left", "--duration", "1s"}, "--duration");
    refused({"--tracker", "sim:table", "--side", "left", "--user", "anna"}, "--glove");
    refused({"--tracker", "sim:dance", "--side", "left"}, "dance");
    refused({"--tracker", "sim:table", "--mounted", "foot", "--side", "left"}, "foot");
  }

  TEST_CASE("the calibration of gloves still takes a glove in its place") {
    const auto glove = nendo::test::nendo({"calibrate", "sim:rest", "--user", "anna"});
    CHECK(glove.exit_code == 2);
    CHECK(is_one_line_about(glove.err, "terminal"));
    const auto help = nendo::test::nendo({"calibrate", "tracker", "--help"});
    CHECK(help.exit_code == 0);
    CHECK(help.out.find("--mounted") != std::string::npos);
  }
}

} // namespace calibrate_tracker_command_test
