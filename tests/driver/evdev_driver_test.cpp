// A tracker that is an input device of the kernel, at emulated nodes.

#include <nendo/driver/open_tracker.hpp>

#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include "support/eventually.hpp"
#include "support/mocked_input.hpp"
#include "support/required.hpp"

namespace evdev_driver_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

MockedInput mouse() {
  return {7, "Optical Mouse", "0", "ff0000 0 0 0 0", "1943", "0", "046d", "c077"};
}
MockedInput keyboard() {
  return {2, "Keyboard", "0", "1000000000007 ff9f207ac14057ff", "0", "0"};
}

std::string error_of(const std::string& spec, Errc code) {
  const auto opened = open_trackers(std::array{spec});
  REQUIRE_FALSE(opened);
  CHECK(opened.error().code == code);
  CHECK(opened.error().message.find('\n') == std::string::npos);
  CHECK(opened.error().message.find(spec) != std::string::npos);
  return opened.error().message;
}

/// A started tracker, and the last pose that came from it.
struct Started {
  explicit Started(const std::string& spec)
      : station(required(open_trackers(std::array{spec})).front()) {
    PoseRing* const rings[]{&ring};
    require_ok(start_trackers(std::array{station}, rings));
  }
  ~Started() { station.tracker->stop(); }
  const PoseSample& last() {
    ring.drain([&](const PoseSample& sample) {
      CHECK(sample.sequence >= poses);
      CHECK(sample.station == 1);
      poses = sample.sequence + 1;
      newest = sample;
    });
    return newest;
  }

  PoseRing ring{4096};
  TrackerStation station;
  PoseSample newest;
  std::uint64_t poses = 0;
};

} // namespace

TEST_SUITE("evdev_driver") {
  TEST_CASE("a name that is none lists the devices that it could be") {
    MockedInputs machine;
    CHECK(error_of("evdev:", Errc::usage).find("plug in a SpaceMouse") != std::string::npos);
    machine.plug(keyboard());
    machine.plug({});
    machine.plug(mouse());
    for (const auto& [spec, code] :
         {std::pair{"evdev:", Errc::usage}, std::pair{"evdev:Wiimote", Errc::no_device},
          std::pair{"evdev:/dev/input/event9", Errc::no_device},
          std::pair{"evdev:event2", Errc::no_device}, std::pair{"evdev:e", Errc::usage}}) {
      const std::string message = error_of(spec, code);
      CAPTURE(message);
      CHECK(message.find("3Dconnexion SpaceNavigator (/dev/input/event5, six axes), "
                         "Optical Mouse (/dev/input/event7, mouse)") != std::string::npos);
      CHECK(message.find("Keyboard (/dev/input/event2,") == std::string::npos);
    }
    CHECK(error_of("evdev:e?speed=0", Errc::usage).find("speed") != std::string::npos);
    CHECK(error_of("evdev:e?turn=7", Errc::usage).find("at most 6") != std::string::npos);
    CHECK(error_of("evdev:e?station=2", Errc::usage).find("station") != std::string::npos);
  }

  TEST_CASE("a device is known by a part of its name, its path, a link and its node") {
    MockedInputs machine;
    machine.plug(keyboard());
    machine.plug({});
    machine.plug(mouse());
    machine.link("by-id/usb-3Dconnexion-event-joystick", {});
    const std::string link = "/dev/input/by-id/usb-3Dconnexion-event-joystick";
    for (const std::string& name :
         {std::string("spacenav"), std::string("/dev/input/event5"), link, std::string("event5")}) {
      const auto opened = required(open_trackers(std::array{"evdev:" + name + "?speed=0.5"}));
      const TrackerInfo& info = opened.front().tracker->info();
      CHECK(info.model == "3Dconnexion SpaceNavigator, six axes");
      CHECK(info.stations == std::vector<std::uint16_t>{1});
      CHECK(info.stage_from_tracker_xyzw == std::array<double, 4>{0, 0, 0, 1});
      CHECK(info.facts.front().value == "/dev/input/event5");
    }
    CHECK_FALSE(machine.grabbed);
  }

  TEST_CASE("poses come at rest, and 120 Hz while a cap is held without further events") {
    MockedInputs machine;
    const MockedInput cap;
    machine.plug(cap);
    Started hand("evdev:SpaceNavigator?speed=0.1");
    CHECK(machine.grabbed);
    REQUIRE(eventually([&] { return hand.last().sequence >= 5; }));
    CHECK(hand.last().position_m == std::array<double, 3>{});
    machine.send(cap, EV_ABS, ABS_X, 350);
    REQUIRE(eventually([&] { return hand.last().position_m[0] > 0.01; }));
    const PoseSample first = hand.last();
    std::this_thread::sleep_for(1s);
    const PoseSample then = hand.last();
    const double seconds = seconds_between(first.arrival, then.arrival);
    CHECK(then.position_m[0] - first.position_m[0] == doctest::Approx(0.1 * seconds).epsilon(0.02));
    const double rate_hz = static_cast<double>(then.sequence - first.sequence) / seconds;
    CAPTURE(rate_hz);
    CHECK(rate_hz < 122.0);
    CHECK(rate_hz > 60.0); // a busy machine
    machine.send(cap, EV_KEY, BTN_0, 1);
    machine.send(cap, EV_ABS, ABS_X, 0);
    CHECK(eventually([&] { return hand.last().position_m[0] == 0.0; }));
    hand.station.tracker->stop();
    CHECK_FALSE(machine.grabbed);
    hand.last();
    const StreamStats stats = hand.station.tracker->stats();
    CHECK(stats.records == hand.poses);
    CHECK(stats.bytes == 6 * sizeof(input_event));
    CHECK(stats.bytes == stats.record_bytes);
    CHECK(stats.silences == 0);
  }

  TEST_CASE("a cap that is held when the stream begins moves the hand at once") {
    MockedInputs machine;
    machine.plug({});
    machine.axis_value = 350;
    Started hand("evdev:SpaceNavigator");
    CHECK(eventually([&] { return hand.last().position_m[0] > 0.01; }));
    machine.axis_value = 0;
    machine.send({}, EV_SYN, SYN_DROPPED, 0);
    CHECK(eventually([&] {
      const double before_m = hand.last().position_m[0];
      std::this_thread::sleep_for(100ms);
      return hand.last().position_m[0] == before_m;
    }));
  }

  TEST_CASE("a device that is plugged in again under another node moves the hand from there") {
    MockedInputs machine;
    machine.plug(mouse());
    Started hand("evdev:Optical Mouse");
    machine.send(mouse(), EV_REL, REL_X, 200);
    const auto is_there = [&] { return hand.last().position_m[0] == doctest::Approx(0.02); };
    REQUIRE(eventually(is_there));
    machine.unplug(mouse());
    std::this_thread::sleep_for(100ms);
    MockedInput moved = mouse();
    moved.number = 9;
    machine.plug(moved);
    REQUIRE(eventually([&] { return hand.station.tracker->stats().reopened == 1; }));
    CHECK(is_there());
    machine.send(moved, EV_REL, REL_WHEEL, 1);
    CHECK(eventually([&] { return hand.last().position_m[2] == doctest::Approx(-0.005); }));
  }

  TEST_CASE("a device that another program keeps is an error that says what to do") {
    MockedInputs machine;
    machine.plug({});
    machine.grabbed_elsewhere = true;
    CHECK(error_of("evdev:SpaceNavigator", Errc::no_device).find("stop spacenavd") !=
          std::string::npos);
  }

  TEST_CASE("a device that only others may open is an error that says what to do") {
    MockedInputs machine;
    machine.plug({});
    machine.plug(mouse());
    for (const MockedInput& input : {MockedInput{}, mouse()}) {
      const auto node = machine.real(input.node());
      std::filesystem::permissions(node, std::filesystem::perms::none);
      if (::access(node.c_str(), R_OK) == 0) return; // root may open everything
    }
    CHECK(error_of("evdev:SpaceNavigator", Errc::no_permission).find("nendo udev install") !=
          std::string::npos);
    const std::string message = error_of("evdev:Optical Mouse", Errc::no_permission);
    CHECK(message.find("TAG+=\"uaccess\"") != std::string::npos);
    CHECK(message.find("ATTRS{id/product}==\"c077\"") != std::string::npos);
  }
}

} // namespace evdev_driver_test
