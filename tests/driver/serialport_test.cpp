// The libserialport back end, discovery and `auto` against an emulated USB-serial adapter. Needs
// umockdev-wrapper around the program; without it these tests fail rather than pass over what they
// are for.

#include <array>
#include <atomic>
#include <string>
#include <thread>

#include <doctest/doctest.h>
#include <sys/ioctl.h>

#include <nendo/driver/devices.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/open_tracker.hpp>

#include "support/mocked_machine.hpp"
#include "support/required.hpp"
#include "support/scripted_port.hpp"
#include "transport/open_transport.hpp"

namespace serialport_test {

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

/// An adapter at /dev/ttyUSB0 with a scripted glove behind it.
class MockedAdapter {
public:
  explicit MockedAdapter(const std::string& product, const std::string& link = "",
                         const Script& script = {}) {
    MockedUsb usb;
    usb.product = product;
    machine.plug(usb);
    if (!link.empty()) machine.link(link, usb.port);
    unit_ = std::thread([this, script, master = machine.master(usb.port)] {
      serve_script(master, script, stop_, mute_);
    });
  }
  ~MockedAdapter() { stop_unit(); }
  MockedAdapter(const MockedAdapter&) = delete;
  MockedAdapter& operator=(const MockedAdapter&) = delete;

  void unplug() {
    stop_unit();
    machine.hang_up("ttyUSB0");
  }

  MockedMachine machine;

private:
  void stop_unit() {
    stop_ = true;
    if (unit_.joinable()) unit_.join();
  }

  std::atomic<bool> stop_{false};
  std::atomic<bool> mute_{false};
  std::thread unit_;
};

} // namespace

TEST_SUITE("serialport") {
  TEST_CASE("a port is opened by libserialport, with both modem lines asserted, for one program") {
    MockedAdapter adapter("FT232R USB UART");
    std::atomic<int>& modem_lines = adapter.machine.modem_lines;
    REQUIRE(is_serial_port("/dev/ttyUSB0"));
    auto transport = required(open_transport("/dev/ttyUSB0", 115'200));
    CHECK((modem_lines & (TIOCM_DTR | TIOCM_RTS)) == (TIOCM_DTR | TIOCM_RTS));

    check_that_it_answers(*transport);
    std::array<std::byte, 16> buffer{};
    CHECK(transport->read_some(buffer, 20ms).status == IoStatus::timeout);

    const auto second = open_transport("/dev/ttyUSB0", 115'200);
    REQUIRE_FALSE(second);
    CHECK(second.error().message.find("in use by another program") != std::string::npos);
  }

  TEST_CASE("an adapter that is unplugged is noticed by reading and by writing") {
    MockedAdapter adapter("FT232R USB UART");
    auto transport = required(open_transport("/dev/ttyUSB0", 115'200));
    adapter.unplug();
    std::array<std::byte, 16> buffer{};
    CHECK(transport->read_some(buffer, 1s).status == IoStatus::gone);
    CHECK(transport->write_all(buffer, 1s) == IoStatus::gone);
  }

  TEST_CASE("a glove behind an adapter streams") {
    const MockedAdapter adapter("FT232R USB UART");
    SampleRing ring(1024);
    auto glove = required(open_glove("serial:/dev/ttyUSB0"));
    test::require_ok(glove->start(ring));
    std::this_thread::sleep_for(500ms);
    glove->stop();
    CHECK(ring.size() > 20);
    CHECK(glove->stats().silences == 0);
  }

  TEST_CASE("a link that udev made is followed") {
    const MockedAdapter adapter("FT232R USB UART", "serial/by-id/usb-FTDI_A1");
    CHECK(resolve_port("/dev/serial/by-id/usb-FTDI_A1") == "/dev/ttyUSB0");
    CHECK(open_transport("/dev/serial/by-id/usb-FTDI_A1", 9'600));
  }

  TEST_CASE(
      "RTS can be lowered, and is low at the port of a Flock of Birds, which it would reset") {
    MockedAdapter adapter("FT232R USB UART");
    std::atomic<int>& modem_lines = adapter.machine.modem_lines;
    {
      auto transport = required(open_transport("/dev/ttyUSB0", 115'200));
      CHECK(transport->set_rts(false));
      CHECK((modem_lines & (TIOCM_DTR | TIOCM_RTS)) == TIOCM_DTR);
      CHECK(transport->set_rts(true));
      CHECK((modem_lines & TIOCM_RTS) == TIOCM_RTS);
    }
    CHECK_FALSE(open_trackers(std::array{std::string("flock:/dev/ttyUSB0?baud=115200")}));
    CHECK((modem_lines & TIOCM_RTS) == 0);
  }

  TEST_CASE("an adapter that anything may hang on is listed, and auto leaves it alone") {
    const MockedAdapter adapter("FT232R USB UART");
    const auto found = find_devices();
    REQUIRE(found.size() == 1);
    CHECK(found[0].spec == "serial:/dev/ttyUSB0");
    CHECK_FALSE(found[0].identified);
    CHECK(found[0].reason.find("may be a glove") != std::string::npos);
    CHECK(found[0].may_open);
    const auto glove = open_glove("auto");
    CHECK(adapter.machine.modem_lines ==
          0); // not even opened, for that would have asserted DTR and RTS
    REQUIRE_FALSE(glove);
    CHECK(glove.error().code == Errc::no_device);
    CHECK(glove.error().message.find("serial:/dev/ttyUSB0") != std::string::npos);
  }

  TEST_CASE("a device that calls itself a glove is opened by auto, if it is the wanted hand") {
    Script script;
    script.right = false;
    const MockedAdapter adapter("CyberGlove III", "", script);
    const auto found = find_devices();
    REQUIRE(found.size() == 1);
    CHECK(found[0].identified);
    CHECK(open_glove("auto:left"));
    // Closed, it is free again for everybody; root, for whom it always was, would not notice.
    const int port = ::open("/dev/ttyUSB0", O_RDWR | O_NOCTTY | O_CLOEXEC);
    int exclusive = -1;
    CHECK(::ioctl(port, TIOCGEXCL, &exclusive) == 0);
    CHECK(exclusive == 0);
    ::close(port);
    CHECK(open_glove("auto"));
    CHECK(open_glove("auto", Side::left));
    const auto right = open_glove("auto:right");
    REQUIRE_FALSE(right);
    CHECK(right.error().message.find("is a left hand") != std::string::npos);
  }

  TEST_CASE("a port that a udev rule names is identified by its link") {
    const MockedAdapter adapter("FT232R USB UART", "nendo/right");
    const auto found = find_devices();
    REQUIRE(found.size() == 1);
    CHECK(found[0].identified);
    CHECK(found[0].spec == "serial:/dev/nendo/right");
    const auto glove = required(open_glove("auto"));
    CHECK(glove->info().source == "serial:/dev/nendo/right");
  }
}

} // namespace serialport_test
