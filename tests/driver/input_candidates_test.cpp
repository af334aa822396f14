// Input devices among the devices that find_devices() and DeviceWatcher list, on emulated machines.

#include <nendo/driver/devices.hpp>

#include <array>
#include <chrono>
#include <filesystem>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/driver/device_watcher.hpp>
#include <nendo/driver/open_tracker.hpp>

#include "evdev/input_device.hpp"
#include "support/mocked_input.hpp"
#include "support/required.hpp"

namespace input_candidates_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

MockedInput keyboard() {
  return {2, "Keyboard", "0", "1000000000007 ff9f207ac14057ff", "0", "0", "046d", "c31c"};
}
MockedInput mouse(int number = 7) {
  return {number, "Optical Mouse", "0", "ff0000 0 0 0 0", "1943", "0", "046d", "c077"};
}
MockedInput gamepad() {
  return {9, "Pad", "0", "1000000000000 0 0 0 0", "0", "1b", "045e", "028e"};
}
MockedInput flight_stick() {
  return {11, "Flight Stick", "0", "ffff00000000 0 0 0 0", "0", "3f", "046d", "c215"};
}

/// Opens the tracker that a candidate's specification names, and returns its node.
std::string opened_by(const DeviceCandidate& candidate) {
  const auto stations = required(open_trackers(std::array{candidate.tracker_spec}));
  return stations.front().tracker->info().facts.front().value;
}

} // namespace

TEST_SUITE("input_candidates") {
  TEST_CASE("what can be a tracker is listed, with a specification that opens it") {
    MockedInputs machine;
    for (const MockedInput& input : {keyboard(), mouse(), gamepad(), flight_stick()})
      machine.plug(input);
    machine.plug({});
    const auto found = find_devices();
    REQUIRE(found.size() == 4);
    const std::vector<std::string> descriptions{"3Dconnexion SpaceNavigator, six axes",
                                                "Optical Mouse, mouse", "Pad, gamepad",
                                                "Flight Stick, six axes"};
    for (std::size_t at = 0; at < found.size(); ++at) {
      CAPTURE(found[at].device);
      CHECK(found[at].description == descriptions[at]);
      CHECK(found[at].kind == DeviceKind::input_device);
      CHECK(found[at].identified == (at == 0)); // the SpaceMouse
      CHECK(found[at].spec.empty());
      CHECK(found[at].may_open);
      CHECK(found[at].remedy.empty());
      CHECK(opened_by(found[at]) == found[at].device);
    }
    CHECK(found[0].tracker_spec == "evdev:3Dconnexion SpaceNavigator");
    CHECK(found[0].reason.find("SpaceMouse") != std::string::npos);
    CHECK(found[2].reason == "may be a tracker: gamepad");
    CHECK_FALSE(machine.grabbed);
  }

  TEST_CASE("a name that names no device alone is replaced by a link, or by the node") {
    MockedInputs machine;
    MockedInput odd = mouse(3);
    SUBCASE("two devices have it") {}
    SUBCASE("a specification cannot express it") {
      odd.name = "Mouse?speed=2";
    }
    SUBCASE("it is a node's") {
      odd.name = "event7";
    }
    SUBCASE("it is a path") {
      odd.name = "/dev/input/event7";
    }
    SUBCASE("it is empty") {
      odd.name = "";
    }
    machine.plug(odd);
    machine.plug(mouse());
    CHECK(find_devices().at(0).tracker_spec == "evdev:/dev/input/event3");
    CHECK(find_devices().at(0).stable_name.empty());
    machine.link("by-path/pci-0000:00:14.0-usb-0:1:1.0-event-mouse", odd);
    machine.link("by-id/usb-Logitech_Optical-event-mouse", odd);
    const auto found = find_devices();
    REQUIRE(found.size() == 2);
    CHECK(found[0].stable_name == "/dev/input/by-id/usb-Logitech_Optical-event-mouse");
    CHECK(found[0].tracker_spec == "evdev:" + found[0].stable_name);
    for (const DeviceCandidate& candidate : found)
      CHECK(opened_by(candidate) == candidate.device);
  }

  TEST_CASE("a SpaceMouse is granted by the rules of nendo, and another device by its own rule") {
    MockedInputs machine;
    machine.plug({});
    machine.plug(mouse());
    const auto remedy_of = [](const std::string& name) {
      const PortAccess access = evdev::refused_input(required(evdev::find_input_device(name)));
      CHECK_FALSE(access.granted);
      CHECK_FALSE(access.who.empty());
      return access.remedy;
    };
    CHECK(remedy_of("event5").find("nendo udev install") != std::string::npos);
    CHECK(remedy_of("event5").find("61-wrist.rules") == std::string::npos);
    CHECK(remedy_of("event7").find("nendo udev install") == std::string::npos);
    CHECK(remedy_of("event7").find("ATTRS{id/vendor}==\"046d\", ATTRS{id/product}==\"c077\", "
                                   "TAG+=\"uaccess\"") != std::string::npos);
  }

  TEST_CASE("an input device without a node is reported, with how to pass it into a container") {
    MockedInputs machine;
    machine.plug({});
    std::filesystem::remove(machine.real("/dev/input/event5"));
    const auto found = find_devices();
    REQUIRE(found.size() == 1);
    CHECK(found[0].node_missing);
    CHECK_FALSE(found[0].may_open);
    CHECK(found[0].access.empty());
    CHECK(found[0].remedy.find("/dev/input/event5") != std::string::npos);
    CHECK(found[0].remedy.find("plug it in again") == std::string::npos);
  }

  TEST_CASE("a SpaceMouse that is plugged in or unplugged is an event") {
    MockedInputs machine;
    bool has_folder = false; // /dev/input
    SUBCASE("beside others") {
      has_folder = true;
      machine.plug(mouse());
    }
    SUBCASE("as the first of the machine") {}
    const auto watcher = required(DeviceWatcher::open());
    CHECK(watcher->present().size() == (has_folder ? 1 : 0));
    machine.plug(keyboard());
    CHECK_FALSE(watcher->next(300ms));
    machine.plug({});
    const auto arrival = watcher->next(20s);
    REQUIRE(arrival);
    CHECK(arrival->attached);
    CHECK(arrival->candidate.tracker_spec == "evdev:3Dconnexion SpaceNavigator");
    machine.unplug({});
    const auto departure = watcher->next(20s);
    REQUIRE(departure);
    CHECK_FALSE(departure->attached);
    CHECK(departure->candidate.device == "/dev/input/event5");
    CHECK_FALSE(watcher->next(300ms));
  }
}

} // namespace input_candidates_test
