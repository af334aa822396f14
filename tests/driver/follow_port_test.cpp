// Ports that go and come back, on an emulated machine.

#include <array>
#include <cstddef>
#include <string>

#include <doctest/doctest.h>

#include "support/mocked_machine.hpp"
#include "support/required.hpp"
#include "support/scripted_port.hpp"
#include "transport/open_transport.hpp"
#include "transport/serial_ports.hpp"

namespace follow_port_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

/// Which port a transport leads to: the one whose far end receives what is written.
bool leads_to(Transport& transport, const MockedMachine& machine, const std::string& port) {
  constexpr std::array question{std::byte{'?'}};
  REQUIRE(transport.write_all(question, 1s) == IoStatus::done);
  pollfd entry{machine.master(port), POLLIN, 0};
  if (::poll(&entry, 1, 500) <= 0) return false;
  char c = 0;
  return ::read(entry.fd, &c, 1) == 1 && c == '?';
}

/// The same adapter, plugged in again elsewhere and under another name.
MockedUsb moved(MockedUsb usb) {
  usb.port = "ttyUSB1";
  usb.place = "1-4";
  usb.address = 9;
  return usb;
}

} // namespace

TEST_SUITE("follow_port") {
  TEST_CASE("an adapter that comes back under another name is opened under that") {
    MockedMachine machine;
    const MockedUsb adapter;
    machine.plug(adapter);
    const auto open = follow_port("/dev/ttyUSB0", 115'200);
    auto transport = required(open());
    CHECK(leads_to(*transport, machine, "ttyUSB0"));
    machine.unplug(adapter);
    transport.reset();
    CHECK_FALSE(open());
    machine.plug(moved(adapter));
    CHECK(leads_to(*required(open()), machine, "ttyUSB1"));
  }

  TEST_CASE("another adapter that took the old name is refused, and the right one found") {
    MockedMachine machine;
    const MockedUsb adapter;
    machine.plug(adapter);
    const auto open = follow_port("/dev/ttyUSB0", 115'200);
    REQUIRE(open());
    machine.unplug(adapter);
    MockedUsb stranger;
    stranger.serial = "A2";
    stranger.address = 8;
    machine.plug(stranger);
    machine.modem_lines = 0;
    const auto refused = open();
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::no_device);
    CHECK(refused.error().message.find("serial number A1") != std::string::npos);
    CHECK(machine.modem_lines == 0); // not even opened
    machine.plug(moved(adapter));
    CHECK(leads_to(*required(open()), machine, "ttyUSB1"));
  }

  TEST_CASE("an adapter without a serial number of its own is known by its place") {
    MockedMachine machine;
    MockedUsb adapter;
    MockedUsb twin = moved({});
    SUBCASE("because it has none") {
      adapter.serial = twin.serial = "";
    }
    SUBCASE("because its twin has the same") {
      adapter.serial = twin.serial = "0001";
    }
    machine.plug(adapter);
    machine.plug(twin);
    const auto open = follow_port("/dev/ttyUSB0", 115'200);
    REQUIRE(open());
    machine.unplug(adapter);
    const auto refused = open();
    REQUIRE_FALSE(refused);
    CHECK(refused.error().message.find("USB place 1-2") != std::string::npos);
    adapter.address = 12;
    machine.plug(adapter);
    CHECK(leads_to(*required(open()), machine, "ttyUSB0"));
  }

  TEST_CASE("nothing is remembered of a port that could not be opened") {
    MockedMachine machine;
    const auto open = follow_port("/dev/ttyUSB0", 115'200);
    const auto missing = open();
    REQUIRE_FALSE(missing);
    CHECK(missing.error().message.find("/dev/ttyUSB0") != std::string::npos);
    machine.plug({});
    CHECK(open());
  }

  TEST_CASE("a link is followed to its adapter, and no further when it leads elsewhere") {
    MockedMachine machine;
    const MockedUsb adapter;
    MockedUsb other = moved({});
    other.serial = "A2";
    machine.plug(adapter);
    machine.plug(other);
    machine.link("serial/by-id/glove", "ttyUSB0");
    const auto open = follow_port("/dev/serial/by-id/glove", 115'200);
    REQUIRE(open());
    machine.link("serial/by-id/glove", "ttyUSB1");
    CHECK(leads_to(*required(open()), machine, "ttyUSB0"));
  }

  TEST_CASE("a pseudo-terminal has no adapter and is opened by its path") {
    const MockedMachine machine; // mocks nothing outside /dev/ttyUSB0
    ScriptedPort port;
    const auto open = follow_port(port.path(), 115'200);
    CHECK(open());
    CHECK(open());
    const std::string path = port.path();
    port.unplug();
    const auto gone = open();
    REQUIRE_FALSE(gone);
    CHECK(gone.error().message.find(path) != std::string::npos);
  }

  TEST_CASE("opening shortens an FTDI adapter's latency timer each time") {
    MockedMachine machine;
    const MockedUsb adapter;
    machine.plug(adapter);
    const auto open = follow_port("/dev/ttyUSB0", 115'200);
    REQUIRE(open());
    CHECK(ftdi_latency_timer("/dev/ttyUSB0") == 1ms);
    machine.unplug(adapter);
    machine.plug(moved(adapter));
    CHECK(ftdi_latency_timer("/dev/ttyUSB1") == 16ms);
    REQUIRE(open());
    CHECK(ftdi_latency_timer("/dev/ttyUSB1") == 1ms);
  }
}

} // namespace follow_port_test
