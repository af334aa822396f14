#include <nendo/hand/tracker_mount.hpp>

#include <cstdlib>
#include <fstream>
#include <limits>
#include <random>
#include <string>

#include <doctest/doctest.h>

#include "support/random_calibration.hpp"
#include "support/temporary_folder.hpp"

namespace tracker_mount_test {

using namespace nendo;
using namespace nendo::hand;
using nendo::test::random_number;
using nendo::test::same_bits;
using nendo::test::TemporaryFolder;

namespace {

const std::string by_hand = R"(version = 1
tracker = "fastrak:/dev/ttyUSB2"
station = 2
side = "left"
mounted = "hand"
position_mm = [61.25, -3.5, 24]
turn_xyzw = [0.0, 0.0, 0.6, 0.8]
stage_from_tracker_xyzw = [0.5, 0.5, -0.5, 0.5]
late_ms = 4.5
residual_mm = 2.25
taken = 2026-11-21T21:27:05+02:00
)";

std::string with(const std::string& what, const std::string& instead) {
  std::string text = by_hand;
  const std::size_t at = text.find(what);
  REQUIRE(at != std::string::npos);
  return text.replace(at, what.size(), instead);
}

std::array<double, 4> random_quaternion(std::mt19937_64& random) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond turn =
      Eigen::Quaterniond(normal(random), normal(random), normal(random), normal(random))
          .normalized();
  return {turn.x(), turn.y(), turn.z(), turn.w()};
}

TrackerMount random_mount(std::mt19937_64& random) {
  TrackerMount mount;
  mount.tracker = nendo::test::random_text(random, 1);
  mount.station = static_cast<std::uint16_t>(random());
  mount.side = random() % 2 ? Side::left : Side::right;
  mount.on_hand = random() % 2 == 0;
  for (double& part : mount.position_mm)
    part = random() % 8 == 0 ? -0.0 : random_number(random, 1000.0);
  mount.turn_xyzw = random_quaternion(random);
  mount.stage_from_tracker_xyzw = random_quaternion(random);
  mount.late_ms = random_number(random, 1000.0);
  mount.residual_mm = std::abs(random_number(random, 1000.0));
  mount.taken = std::chrono::sys_seconds(std::chrono::seconds(random() % 253402300800ULL));
  return mount;
}

} // namespace

TEST_SUITE("tracker mount") {
  TEST_CASE("a file says what its text says") {
    const auto read = parse_mount(by_hand, "m.toml");
    REQUIRE_MESSAGE(read, read.error().message);
    CHECK(read->tracker == "fastrak:/dev/ttyUSB2");
    CHECK(read->station == 2);
    CHECK(read->side == Side::left);
    CHECK(read->on_hand);
    CHECK(read->late_ms == 4.5);
    CHECK(read->residual_mm == 2.25);
    const WristMount mount = wrist_mount(*read);
    CHECK(mount.on_hand);
    CHECK(mount.late_s == doctest::Approx(0.0045));
    CHECK(mount.T_station_wrist.translation().isApprox(Eigen::Vector3d(0.06125, -0.0035, 0.024)));
    // Twice atan2(0.6, 0.8) about z: cos = 0.28, sin = 0.96.
    CHECK((mount.T_station_wrist.linear() * Eigen::Vector3d::UnitX())
              .isApprox(Eigen::Vector3d(0.28, 0.96, 0.0)));
    CHECK((mount.stage_from_tracker * Eigen::Vector3d::UnitX())
              .isApprox(Eigen::Vector3d(0.0, 0.0, -1.0))); // FASTRAK's x is the stage's front
  }

  TEST_CASE("written and read back, every bit is the same") {
    std::mt19937_64 random(1);
    for (int k = 0; k < 500; ++k) {
      const TrackerMount mount = random_mount(random);
      const auto text = mount_text(mount);
      REQUIRE_MESSAGE(text, text.error().message);
      const auto read = parse_mount(*text, "m.toml");
      REQUIRE_MESSAGE(read, read.error().message);
      CHECK(*read == mount);
      for (std::size_t part = 0; part < 3; ++part)
        CHECK(same_bits(read->position_mm[part], mount.position_mm[part]));
      CHECK(*mount_text(*read) == *text);
    }
  }

  TEST_CASE("a mount goes into a file and back") {
    WristMount mount;
    mount.stage_from_tracker = Eigen::Quaterniond(0.5, 0.5, 0.5, -0.5);
    mount.T_station_wrist.translation() << 0.06, -0.01, 0.02;
    mount.T_station_wrist.linear() =
        Eigen::AngleAxisd(0.3, Eigen::Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    mount.late_s = 0.0125;
    TrackerMount file;
    set_mount(file, mount);
    const WristMount back = wrist_mount(file);
    CHECK(back.T_station_wrist.isApprox(mount.T_station_wrist, 1e-12));
    CHECK(back.stage_from_tracker.isApprox(mount.stage_from_tracker, 1e-12));
    CHECK(back.late_s == doctest::Approx(mount.late_s).epsilon(1e-12));
    CHECK(!back.on_hand);
  }

  TEST_CASE("what is wrong in a file is said in one line with its line and key") {
    const auto fails = [](const std::string& text, const std::string& place,
                          const std::string& key) {
      const auto read = parse_mount(text, "m.toml");
      REQUIRE(!read);
      const std::string& message = read.error().message;
      CAPTURE(message);
      CHECK(read.error().code == Errc::bad_input);
      CHECK(message.starts_with(place));
      CHECK(message.find(key) != std::string::npos);
      CHECK(message.find('\n') == std::string::npos);
    };
    fails(with("side = \"left\"", "side = \"both\""), "m.toml:4", "side");
    fails(with("side = \"left\"\n", ""), "m.toml:1", "side");
    fails(with("mounted = \"hand\"", "mounted = \"elbow\""), "m.toml:5", "mounted");
    fails(with("[61.25, -3.5, 24]", "[61.25, -3.5]"), "m.toml:6", "position_mm");
    fails(with("[61.25, -3.5, 24]", "[61.25, -3.5, 2400]"), "m.toml:6", "position_mm");
    fails(with("[61.25, -3.5, 24]", "[nan, -3.5, 24]"), "m.toml:6", "position_mm");
    fails(with("[61.25, -3.5, 24]", "\"here\""), "m.toml:6", "position_mm");
    fails(with("0.6, 0.8]", "0.6, 0.9]"), "m.toml:7", "turn_xyzw");
    fails(with("0.6, 0.8]", "inf, 0.8]"), "m.toml:7", "turn_xyzw");
    fails(with("-0.5, 0.5]", "0, 0]"), "m.toml:8", "stage_from_tracker_xyzw");
    fails(with("late_ms = 4.5", "late_ms = 1e9"), "m.toml:9", "late_ms");
    fails(with("late_ms = 4.5", "late_ms = true"), "m.toml:9", "late_ms");
    fails(with("residual_mm = 2.25", "residual_mm = -1"), "m.toml:10", "residual_mm");
    fails(with("2026-11-21T21:27:05+02:00", "\"today\""), "m.toml:11", "taken");
    fails(with("2026-11-21T21:27:05+02:00", "1926-11-21T21:27:05Z"), "m.toml:11", "taken");
    fails(with("station = 2", "station = -1"), "m.toml:3", "station");
    fails(with("station = 2", "station = 70000"), "m.toml:3", "station");
    fails(with("fastrak:/dev/ttyUSB2", ""), "m.toml:2", "tracker");
    fails(with("version = 1", "version = 2"), "m.toml:1", "version");
    fails(by_hand + "colour = \"red\"\n", "m.toml:12", "colour");
    fails(std::string(20000, '['), "m.toml:1", "");
    fails(std::string("\0\xff", 2), "m.toml:1", "");
  }

  TEST_CASE("a mount that no reader would take is not written") {
    TrackerMount mount = *parse_mount(by_hand, "m.toml");
    mount.late_ms = std::numeric_limits<double>::quiet_NaN();
    CHECK(mount_text(mount).error().message.find("late_ms") != std::string::npos);
    mount.late_ms = 0.0;
    mount.tracker = "two\nlines";
    CHECK(!mount_text(mount));
    const TemporaryFolder folder;
    CHECK(!write_mount(folder.path() / "m.toml", mount));
    CHECK(!std::filesystem::exists(folder.path() / "m.toml"));
  }

  TEST_CASE("a mount is found by tracker, station and side, whatever the options") {
    const TemporaryFolder folder;
    REQUIRE(::setenv("XDG_CONFIG_HOME", folder.path().c_str(), 1) == 0);
    TrackerMount mount = *parse_mount(by_hand, "m.toml");
    const auto none = find_mount("fastrak:/dev/ttyUSB2", 2, Side::left);
    REQUIRE(none);
    CHECK(!none->has_value());
    const auto path = own_mount_path("fastrak:/dev/ttyUSB2?baud=115200", 2, Side::left);
    REQUIRE(path);
    REQUIRE(write_mount(*path, mount));
    const auto found = find_mount("fastrak:/dev/ttyUSB2?station=2", 2, Side::left);
    REQUIRE(found);
    REQUIRE(found->has_value());
    CHECK(**found == mount);
    CHECK(!find_mount("fastrak:/dev/ttyUSB2", 1, Side::left)->has_value());
    CHECK(!find_mount("fastrak:/dev/ttyUSB2", 2, Side::right)->has_value());
    CHECK(!find_mount("fastrak:/dev/ttyUSB3", 2, Side::left)->has_value());
    std::ofstream(*path) << "no mount";
    CHECK(!find_mount("fastrak:/dev/ttyUSB2", 2, Side::left));
  }
}

} // namespace tracker_mount_test
