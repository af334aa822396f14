// The libserialport back end, discovery and `auto` against an emulated USB-serial adapter. Needs
// umockdev-wrapper around the program; without it these tests fail rather than pass over what they
// are for.

#include <array>
#include <atomic>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include <doctest/doctest.h>
#include <sys/ioctl.h>
#include <umockdev.h>

#include <nendo/driver/open_glove.hpp>

#include "support/scripted_port.hpp"
#include "transport/open_transport.hpp"

using namespace nendo;
using namespace nendo::driver;
using namespace nendo::test;
using namespace std::chrono_literals;

namespace {

std::atomic<int> modem_lines{0};

constexpr int not_handled = -100; // umockdev: run it on the pseudo-terminal behind the mock

/// The modem lines, which pseudo-terminals lack; everything else is theirs.
gboolean handle_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer) {
  const auto request = umockdev_ioctl_client_get_request(client);
  if (request != TIOCMGET && request != TIOCMSET && request != TIOCMBIS && request != TIOCMBIC) {
    umockdev_ioctl_client_complete(client, not_handled, 0);
    return TRUE;
  }
  UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
  UMockdevIoctlData* value = umockdev_ioctl_data_resolve(argument, 0, sizeof(int), nullptr);
  int lines = 0;
  std::memcpy(&lines, value->data, sizeof lines);
  if (request == TIOCMSET) modem_lines = lines;
  if (request == TIOCMBIS) modem_lines |= lines;
  if (request == TIOCMBIC) modem_lines &= ~lines;
  if (request == TIOCMGET) {
    lines = modem_lines;
    std::memcpy(value->data, &lines, sizeof lines);
  }
  umockdev_ioctl_client_complete(client, 0, 0);
  return TRUE;
}

/// An FTDI adapter as the kernel and udev describe it, as far as libudev and its users look.
std::string adapter_description(const std::string& product) {
  return R"(P: /devices/pci0000:00/0000:00:14.0/usb1/1-2
N: bus/usb/001/005
E: DEVNAME=/dev/bus/usb/001/005
E: DEVTYPE=usb_device
E: DRIVER=usb
E: SUBSYSTEM=usb
E: BUSNUM=001
E: DEVNUM=005
E: MAJOR=189
E: MINOR=4
A: busnum=1\n
A: devnum=5\n
A: speed=12\n
A: idVendor=0403\n
A: idProduct=6001\n
A: manufacturer=FTDI\n
A: serial=A1\n
A: product=)" +
         product + R"(\n

P: /devices/pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0
E: DEVTYPE=usb_interface
E: DRIVER=ftdi_sio
E: SUBSYSTEM=usb

P: /devices/pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0/ttyUSB0
E: DRIVER=ftdi_sio
E: SUBSYSTEM=usb-serial

P: /devices/pci0000:00/0000:00:14.0/usb1/1-2/1-2:1.0/ttyUSB0/tty/ttyUSB0
N: ttyUSB0
E: DEVNAME=/dev/ttyUSB0
E: MAJOR=188
E: MINOR=0
E: SUBSYSTEM=tty
A: dev=188:0\n
L: device=../../../ttyUSB0
)";
}

struct Unref {
  void operator()(gpointer object) const { g_object_unref(object); }
};

/// An adapter at /dev/ttyUSB0 with a scripted glove behind it.
class MockedAdapter {
public:
  explicit MockedAdapter(const std::string& product, const std::string& link = "",
                         const Script& script = {})
      : testbed_(umockdev_testbed_new()) {
    REQUIRE_MESSAGE(umockdev_in_mock_environment(), "run this program under umockdev-wrapper");
    GError* error = nullptr;
    const std::string description = adapter_description(product);
    REQUIRE(umockdev_testbed_add_from_string(testbed_.get(), description.c_str(), &error));
    if (!link.empty()) make_link(link);
    ioctls_.reset(umockdev_ioctl_base_new());
    g_signal_connect(ioctls_.get(), "handle-ioctl", G_CALLBACK(handle_ioctl), nullptr);
    REQUIRE(umockdev_testbed_attach_ioctl(testbed_.get(), "/dev/ttyUSB0", ioctls_.get(), &error));
    master_ = umockdev_testbed_get_dev_fd(testbed_.get(), "/dev/ttyUSB0");
    REQUIRE(master_ >= 0);
    unit_ = std::thread([this, script] { serve_script(master_, script, stop_, mute_); });
  }
  ~MockedAdapter() {
    stop_unit();
    umockdev_testbed_detach_ioctl(testbed_.get(), "/dev/ttyUSB0", nullptr);
  }
  MockedAdapter(const MockedAdapter&) = delete;
  MockedAdapter& operator=(const MockedAdapter&) = delete;

  /// Hangs up. Another file takes the master's number, which is umockdev's to close.
  void unplug() {
    stop_unit();
    const int nothing = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    ::dup3(nothing, master_, O_CLOEXEC);
    ::close(nothing);
  }

private:
  void stop_unit() {
    stop_ = true;
    if (unit_.joinable()) unit_.join();
  }
  /// As udev does it, relative; umockdev's own links lead out of its mocked /dev.
  void make_link(const std::filesystem::path& link) {
    const std::unique_ptr<gchar, decltype(&g_free)> root(
        umockdev_testbed_get_root_dir(testbed_.get()), g_free);
    const auto dev = std::filesystem::path(root.get()) / "dev";
    const auto folder = (dev / link).parent_path();
    std::filesystem::create_directories(folder);
    std::filesystem::create_symlink(std::filesystem::relative(dev, folder) / "ttyUSB0", dev / link);
  }

  std::unique_ptr<UMockdevTestbed, Unref> testbed_;
  std::unique_ptr<UMockdevIoctlBase, Unref> ioctls_;
  int master_ = -1;
  std::atomic<bool> stop_{false};
  std::atomic<bool> mute_{false};
  std::thread unit_;
};

} // namespace

TEST_SUITE("serialport") {
  TEST_CASE("a port is opened by libserialport, with both modem lines asserted, for one program") {
    const MockedAdapter adapter("FT232R USB UART");
    modem_lines = 0;
    REQUIRE(is_serial_port("/dev/ttyUSB0"));
    auto transport = open_transport("/dev/ttyUSB0", 115'200);
    REQUIRE_MESSAGE(transport, transport.error().message);
    CHECK((modem_lines & (TIOCM_DTR | TIOCM_RTS)) == (TIOCM_DTR | TIOCM_RTS));

    constexpr std::array question{std::byte{'?'}, std::byte{'S'}};
    CHECK((*transport)->write_all(question, 1s) == IoStatus::done);
    std::string received;
    std::array<std::byte, 16> buffer{};
    while (received.size() < 4) {
      const auto [status, count] = (*transport)->read_some(buffer, 1s);
      REQUIRE(status == IoStatus::done);
      for (std::size_t k = 0; k < count; ++k)
        received.push_back(std::to_integer<char>(buffer[k]));
    }
    CHECK(received == std::string("?S\x16\0", 4));
    CHECK((*transport)->read_some(buffer, 20ms).status == IoStatus::timeout);

    const auto second = open_transport("/dev/ttyUSB0", 115'200);
    REQUIRE_FALSE(second);
    CHECK(second.error().message.find("in use by another program") != std::string::npos);
  }

  TEST_CASE("an adapter that is unplugged is noticed by reading and by writing") {
    MockedAdapter adapter("FT232R USB UART");
    auto transport = open_transport("/dev/ttyUSB0", 115'200);
    REQUIRE_MESSAGE(transport, transport.error().message);
    adapter.unplug();
    std::array<std::byte, 16> buffer{};
    CHECK((*transport)->read_some(buffer, 1s).status == IoStatus::gone);
    CHECK((*transport)->write_all(buffer, 1s) == IoStatus::gone);
  }

  TEST_CASE("a glove behind an adapter streams") {
    const MockedAdapter adapter("FT232R USB UART");
    SampleRing ring(1024);
    auto glove = open_glove("serial:/dev/ttyUSB0");
    REQUIRE_MESSAGE(glove, glove.error().message);
    REQUIRE((*glove)->start(ring));
    std::this_thread::sleep_for(500ms);
    (*glove)->stop();
    CHECK(ring.size() > 20);
    CHECK((*glove)->stats().silences == 0);
  }

  TEST_CASE("a link that udev made is followed") {
    const MockedAdapter adapter("FT232R USB UART", "serial/by-id/usb-FTDI_A1");
    CHECK(resolve_port("/dev/serial/by-id/usb-FTDI_A1") == "/dev/ttyUSB0");
    CHECK(open_transport("/dev/serial/by-id/usb-FTDI_A1", 9'600));
  }

  TEST_CASE("an adapter that anything may hang on is listed, and auto leaves it alone") {
    const MockedAdapter adapter("FT232R USB UART");
    const auto found = find_gloves();
    REQUIRE(found.size() == 1);
    CHECK(found[0].spec == "serial:/dev/ttyUSB0");
    CHECK_FALSE(found[0].identified);
    CHECK(found[0].reason.find("may be a glove") != std::string::npos);
    CHECK(found[0].may_open);
    modem_lines = 0;
    const auto glove = open_glove("auto");
    CHECK(modem_lines == 0); // not even opened, for that would have asserted DTR and RTS
    REQUIRE_FALSE(glove);
    CHECK(glove.error().code == Errc::no_device);
    CHECK(glove.error().message.find("serial:/dev/ttyUSB0") != std::string::npos);
  }

  TEST_CASE("a device that calls itself a glove is opened by auto, if it is the wanted hand") {
    Script script;
    script.right = false;
    const MockedAdapter adapter("CyberGlove III", "", script);
    const auto found = find_gloves();
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
    const auto found = find_gloves();
    REQUIRE(found.size() == 1);
    CHECK(found[0].identified);
    CHECK(found[0].spec == "serial:/dev/nendo/right");
    const auto glove = open_glove("auto");
    REQUIRE_MESSAGE(glove, glove.error().message);
    CHECK((*glove)->info().source == "serial:/dev/nendo/right");
  }
}
