#include "transport/usb_transport.hpp"

#include <array>
#include <chrono>
#include <string>
#include <vector>

#include <doctest/doctest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <nendo/driver/open_glove.hpp>

#include "support/mocked_usb.hpp"
#include "support/required.hpp"

namespace usb_transport_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

using Clock = std::chrono::steady_clock;

const UsbWanted a_p5{{0x0D7F, 0x0100}, {}, {}};
const UsbInterface p5_interface{1, 24};
const UsbWanted an_ultra{{0x5D70, 0x0000}, {}, {}};
const UsbInterface ultra_interface{0, 64};

UsbBytes read_report(UsbTransport& transport, std::chrono::milliseconds timeout = 2s) {
  std::array<std::byte, max_usb_report_bytes> buffer{};
  const auto [status, count] = transport.read_some(buffer, timeout);
  UsbBytes bytes;
  if (status != IoStatus::done) return bytes;
  for (std::size_t k = 0; k < count; ++k)
    bytes.push_back(std::to_integer<std::uint8_t>(buffer[k]));
  return bytes;
}

/// Whether reading says that the device is gone, after the reports that had arrived.
bool is_gone_after_reports(UsbTransport& transport) {
  std::array<std::byte, max_usb_report_bytes> buffer{};
  for (int k = 0; k < 1000; ++k) {
    if (transport.read_some(buffer, 2s).status == IoStatus::gone) return true;
  }
  return false;
}

/// Reports of 24 bytes, numbered.
std::vector<UsbBytes> numbered_reports(std::size_t count) {
  std::vector<UsbBytes> reports;
  for (std::size_t k = 0; k < count; ++k) {
    UsbBytes report(24, 0);
    report[0] = static_cast<std::uint8_t>(k & 0xFFU);
    report[1] = static_cast<std::uint8_t>(k >> 8U);
    reports.push_back(report);
  }
  return reports;
}

} // namespace

TEST_SUITE("usb_transport") {
  TEST_CASE(
      "the interface is taken from the kernel's driver and given back, the mouse left alone") {
    MockedUsb bus;
    P5Model glove;
    auto& device = bus.plug(glove, 3, 7);
    {
      auto transport = required(open_usb(a_p5, p5_interface));
      const UsbLog open = MockedUsb::log_of(device);
      CHECK(open.claimed);
      CHECK(open.detached == 1);
      CHECK_FALSE(open.kernel_has_glove);
    }
    const UsbLog closed = MockedUsb::log_of(device);
    CHECK_FALSE(closed.claimed);
    CHECK(closed.detached == 1);
    CHECK(closed.attached == 1);
    CHECK(closed.kernel_has_glove);
    CHECK(closed.kernel_has_mouse);
    CHECK(closed.under_way == 0);
  }

  TEST_CASE("reports arrive whole and in order, several transfers being under way") {
    MockedUsb bus;
    P5Model glove;
    glove.odd_reports = numbered_reports(400);
    auto& device = bus.plug(glove, 3, 7);
    auto transport = required(open_usb(a_p5, p5_interface));
    for (const UsbBytes& expected : numbered_reports(400))
      REQUIRE(read_report(*transport) == expected);
    CHECK(MockedUsb::log_of(device).max_under_way >= 8);
  }

  TEST_CASE("what was thrown away does not arrive, what follows does, and nothing stops") {
    MockedUsb bus;
    P5Model glove;
    glove.odd_reports = numbered_reports(200);
    bus.plug(glove, 3, 7);
    auto transport = required(open_usb(a_p5, p5_interface));
    int last = -1;
    for (int k = 0; k < 100; ++k) {
      if (k % 10 == 5) transport->discard_input();
      const UsbBytes report = read_report(*transport);
      REQUIRE(report.size() == 24);
      if (report[1] != 0 || last >= 150) break;
      CHECK(int{report[0]} > last);
      last = report[0];
    }
    CHECK(last >= 90);
  }

  TEST_CASE("a glove that says nothing is a timeout, and no report of length zero is handed on") {
    MockedUsb bus;
    P5Model glove;
    glove.silent = true;
    auto& device = bus.plug(glove, 3, 7);
    auto transport = required(open_usb(a_p5, p5_interface));
    std::array<std::byte, max_usb_report_bytes> buffer{};
    const auto start = Clock::now();
    CHECK(transport->read_some(buffer, 50ms).status == IoStatus::timeout);
    CHECK(Clock::now() - start >= 50ms);
    MockedUsb::send_nothing(device);
    CHECK(transport->read_some(buffer, 50ms).status == IoStatus::timeout);
    MockedUsb::with_model(device, [&] { glove.silent = false; });
    CHECK(read_report(*transport).size() == 24);
  }

  TEST_CASE("single bus errors are survived, errors without end are the end") {
    MockedUsb bus;
    P5Model glove;
    auto& device = bus.plug(glove, 3, 7);
    auto transport = required(open_usb(a_p5, p5_interface));
    MockedUsb::spoil(device, 20);
    for (int k = 0; k < 40; ++k)
      REQUIRE(read_report(*transport).size() == 24);
    MockedUsb::spoil(device, 1'000'000);
    CHECK(is_gone_after_reports(*transport));
  }

  TEST_CASE(
      "an unplugged device is gone, after the reports that had arrived, and closes promptly") {
    MockedUsb bus;
    P5Model glove;
    auto& device = bus.plug(glove, 3, 7);
    auto transport = required(open_usb(a_p5, p5_interface));
    REQUIRE(read_report(*transport).size() == 24);
    bus.unplug(device);
    CHECK(is_gone_after_reports(*transport));
    std::array<std::byte, max_usb_report_bytes> buffer{};
    CHECK(transport->read_some(buffer, 2s).status == IoStatus::gone);
    CHECK(transport->write_all(buffer, 2s) == IoStatus::gone);
    std::array feature{std::byte{5}, std::byte{0}};
    std::size_t received = 0;
    CHECK(transport->get_feature(feature, received, 100ms) == ControlStatus::gone);
    CHECK(transport->set_feature(feature, 100ms) == ControlStatus::gone);
    const auto start = Clock::now();
    transport.reset();
    CHECK(Clock::now() - start < 1s);
  }

  TEST_CASE("feature reports are asked for and set at the glove's interface, or refused") {
    MockedUsb bus;
    P5Model glove;
    auto& device = bus.plug(glove, 3, 7);
    auto transport = required(open_usb(a_p5, p5_interface));
    std::array feature{std::byte{5}, std::byte{0}};
    std::size_t received = 0;
    CHECK(transport->get_feature(feature, received, 1s) == ControlStatus::done);
    CHECK(received == 2);
    CHECK(feature == std::array{std::byte{5}, std::byte{1}});
    CHECK(transport->set_feature(std::array{std::byte{5}, std::byte{0xFF}}, 1s) ==
          ControlStatus::done);
    MockedUsb::with_model(device, [&] { CHECK(glove.mouse_mode == 0xFF); });
    std::array stranger{std::byte{99}, std::byte{0}};
    CHECK(transport->get_feature(stranger, received, 1s) == ControlStatus::refused);
    CHECK(transport->set_feature(stranger, 1s) == ControlStatus::refused);
    CHECK(received == 0);
    // A P5 has no output: nothing can be written to it.
    CHECK(transport->write_all(stranger, 20ms) == IoStatus::timeout);
    // The kernel's driver asks a device to be silent while nothing changes: that is undone.
    CHECK(MockedUsb::log_of(device).controls.front() ==
          UsbBytes{0x21, 0x0A, 0x00, 25, 0x01, 0x00, 0x00, 0x00});
    CHECK(read_report(*transport).size() == 24);
  }

  TEST_CASE("of several gloves the wanted one is opened, or the first that is free") {
    MockedUsb bus;
    P5Model first;
    P5Model second;
    P5Model third;
    auto& first_device = bus.plug(first, 3, 7, "A1");
    auto& second_device = bus.plug(second, 4, 8, "B2");
    bus.plug(third, 5, 9);
    UsbWanted wanted = a_p5;
    wanted.serial = "B2";
    auto by_serial = required(open_usb(wanted, p5_interface));
    CHECK(by_serial->identity().address == 8);
    CHECK(by_serial->identity().serial == "B2");
    CHECK(by_serial->identity().manufacturer == "a maker? of gloves"); // its escape is gone
    CHECK(MockedUsb::log_of(second_device).claimed);
    const auto taken = open_usb(wanted, p5_interface);
    REQUIRE_FALSE(taken);
    CHECK(taken.error().code == Errc::no_device);
    CHECK(taken.error().message.find("in use by another program") != std::string::npos);

    wanted.serial.clear();
    wanted.port = "1-5";
    auto by_port = required(open_usb(wanted, p5_interface));
    CHECK(by_port->identity().address == 9);
    CHECK(by_port->identity().serial.empty());

    auto free = required(open_usb(a_p5, p5_interface));
    CHECK(free->identity().place == "1-3");
    CHECK(MockedUsb::log_of(first_device).claimed);
  }

  TEST_CASE("what cannot be opened is an error in one line that says why") {
    MockedUsb bus;
    const auto absent = open_usb(a_p5, p5_interface);
    REQUIRE_FALSE(absent);
    CHECK(absent.error().code == Errc::no_device);
    CHECK(absent.error().message.find("0d7f:0100") != std::string::npos);

    UltraModel glove(0x0000);
    bus.plug(glove, 3, 7);
    CHECK(open_usb(an_ultra, ultra_interface));
    UsbWanted other = an_ultra;
    other.serial = "C3";
    CHECK(open_usb(other, ultra_interface).error().message.find("C3") != std::string::npos);
    const auto no_interface = open_usb(an_ultra, {5, 64});
    REQUIRE_FALSE(no_interface);
    CHECK(no_interface.error().code == Errc::no_device);
    CHECK(no_interface.error().message.find("interface") != std::string::npos);
  }

  TEST_CASE("a device that this user may not open names its node and the rule that fixes it") {
    MockedUsb bus;
    P5Model glove;
    auto& device = bus.plug(glove, 3, 7);
    const std::string file = bus.node_file(device);
    // Root may open everything: it steps down for a moment, into a folder that it opens to others.
    const bool root = ::geteuid() == 0;
    REQUIRE(::chmod(bus.root().c_str(), 0777) == 0);
    REQUIRE(::chmod((bus.root() + "/ioctl/dev/bus/usb/001/007").c_str(), 0777) == 0);
    REQUIRE(::chmod(file.c_str(), 0) == 0);
    if (root) REQUIRE(::seteuid(65534) == 0);
    const auto refused = open_glove("usb:0d7f:0100");
    if (root) REQUIRE(::seteuid(0) == 0);
    REQUIRE_FALSE(refused);
    CHECK(refused.error().code == Errc::no_permission);
    CAPTURE(refused.error().message);
    CHECK(refused.error().message.find("/dev/bus/usb/001/007") != std::string::npos);
    CHECK(refused.error().message.find("nendo udev install") != std::string::npos);
    CHECK(MockedUsb::log_of(device).detached == 0);
  }
}

} // namespace usb_transport_test
