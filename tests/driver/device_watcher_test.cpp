// Plugging in and pulling out, on an emulated machine whose uevents libudev hears.

#include <string>
#include <thread>

#include <doctest/doctest.h>

#include <nendo/base/units.hpp>
#include <nendo/driver/device_watcher.hpp>

#include "support/mocked_machine.hpp"

namespace device_watcher_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

std::unique_ptr<DeviceWatcher> watch() {
  auto watcher = DeviceWatcher::open();
  REQUIRE_MESSAGE(watcher, watcher.error().message);
  return *std::move(watcher);
}

DeviceEvent next_event(DeviceWatcher& watcher) {
  const auto event = watcher.next(20s);
  REQUIRE(event);
  return *event;
}

} // namespace

TEST_SUITE("device_watcher") {
  TEST_CASE("an adapter's arrival and departure are one event each, with its port") {
    MockedMachine machine;
    MockedUsb neighbour;
    neighbour.place = "1-7";
    neighbour.address = 20;
    machine.plug(neighbour);
    const auto watcher = watch();
    CHECK(watcher->sees_usb());
    REQUIRE(watcher->present().size() == 1);
    CHECK(watcher->present()[0].device == "/dev/ttyUSB0");

    MockedUsb adapter;
    adapter.port = "ttyUSB1";
    adapter.serial = "A2";
    machine.plug_usb(adapter);
    CHECK_FALSE(watcher->next(300ms)); // its port is not made yet
    machine.plug_port(adapter);
    const DeviceEvent arrival = next_event(*watcher);
    CHECK(arrival.attached);
    CHECK(arrival.candidate.device == "/dev/ttyUSB1");
    REQUIRE(arrival.candidate.usb);
    CHECK(arrival.candidate.usb->serial == "A2");

    machine.unplug(adapter);
    const DeviceEvent departure = next_event(*watcher);
    CHECK_FALSE(departure.attached);
    CHECK(departure.candidate.device == "/dev/ttyUSB1");
    CHECK_FALSE(watcher->next(300ms));
  }

  TEST_CASE("a USB glove without a port is announced by its event alone") {
    MockedMachine machine;
    const auto watcher = watch();
    MockedUsb glove;
    glove.port = "";
    glove.vendor_id = "0d7f";
    glove.product_id = "0100";
    machine.plug(glove);
    const DeviceEvent arrival = next_event(*watcher);
    CHECK(arrival.attached);
    CHECK(arrival.candidate.spec == "usb:0d7f:0100");
    machine.unplug(glove);
    CHECK_FALSE(next_event(*watcher).attached);
  }

  TEST_CASE("an adapter that never gets a port is announced after two seconds") {
    MockedMachine machine;
    const auto watcher = watch();
    MockedUsb adapter;
    adapter.port = "";
    machine.plug(adapter);
    const HostTime begin = HostClock::now();
    const DeviceEvent arrival = next_event(*watcher);
    CHECK(HostClock::now() - begin > 1500ms);
    CHECK(arrival.candidate.kind == DeviceKind::portless_adapter);
  }

  TEST_CASE("another adapter under the same name is a departure and an arrival") {
    MockedMachine machine;
    MockedUsb adapter;
    machine.plug(adapter);
    const auto watcher = watch();
    machine.unplug(adapter);
    adapter.address = 6;
    adapter.serial = "A2";
    machine.plug(adapter);
    const DeviceEvent departure = next_event(*watcher);
    CHECK_FALSE(departure.attached);
    CHECK(departure.candidate.usb->serial == "A1");
    const DeviceEvent arrival = next_event(*watcher);
    CHECK(arrival.attached);
    CHECK(arrival.candidate.usb->serial == "A2");
  }

  TEST_CASE("a Bluetooth port without an event is seen in /dev") {
    MockedMachine machine;
    std::filesystem::create_directories(machine.real("/dev"));
    const auto watcher = watch();
    // As the kernel makes it, but without an event: only /dev shows it, as in some containers.
    machine.write("/sys/devices/virtual/tty/rfcomm0/uevent",
                  "MAJOR=216\nMINOR=0\nDEVNAME=rfcomm0\n");
    machine.write("/sys/devices/virtual/tty/rfcomm0/dev", "216:0\n");
    std::filesystem::create_directories(machine.real("/sys/class/tty"));
    std::filesystem::create_symlink("../../../../class/tty",
                                    machine.real("/sys/devices/virtual/tty/rfcomm0/subsystem"));
    std::filesystem::create_symlink("../../devices/virtual/tty/rfcomm0",
                                    machine.real("/sys/class/tty/rfcomm0"));
    machine.write("/dev/rfcomm0", "");
    const DeviceEvent arrival = next_event(*watcher);
    CHECK(arrival.attached);
    CHECK(arrival.candidate.device == "/dev/rfcomm0");
    std::filesystem::remove(machine.real("/sys/class/tty/rfcomm0"));
    std::filesystem::remove(machine.real("/dev/rfcomm0"));
    CHECK_FALSE(next_event(*watcher).attached);
  }

  TEST_CASE("stop ends a wait, and all that follow") {
    const MockedMachine machine;
    const auto watcher = watch();
    const HostTime begin = HostClock::now();
    std::thread stopper([&] { watcher->stop(); });
    CHECK_FALSE(watcher->next(60s));
    stopper.join();
    CHECK_FALSE(watcher->next(60s));
    CHECK(HostClock::now() - begin < 30s);
  }

  TEST_CASE("without an event next ends in time, at once if no time is given") {
    const MockedMachine machine;
    const auto watcher = watch();
    CHECK_FALSE(watcher->next(0ms));
    CHECK_FALSE(watcher->next(-1s));
    const HostTime begin = HostClock::now();
    CHECK_FALSE(watcher->next(100ms));
    CHECK(HostClock::now() - begin >= 100ms);
  }
}

} // namespace device_watcher_test
