#pragma once
// A machine with USB-serial adapters and USB gloves that umockdev makes of text: their entries in
// /sys, nodes in /dev, uevents, and modem lines. The program must run under umockdev-wrapper.

#include <atomic>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <memory>
#include <string>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <umockdev.h>
#include <unistd.h>

namespace nendo::test {

/// A USB device and, if `port` is not empty, its serial port.
struct MockedUsb {
  std::string port = "ttyUSB0";
  std::string place = "1-2";
  unsigned address = 5;
  std::string vendor_id = "0403";
  std::string product_id = "6001";
  std::string manufacturer = "FTDI";
  std::string product = "FT232R USB UART";
  std::string serial = "A1"; ///< empty: it has none
  std::string driver = "ftdi_sio";

  std::string syspath() const { return "/sys/devices/pci0000:00/0000:00:14.0/usb1/" + place; }
  std::string interface_path() const { return syspath() + "/" + place + ":1.0"; }
  std::string tty_path() const { return interface_path() + "/" + port + "/tty/" + port; }
};

class MockedMachine {
public:
  MockedMachine() : testbed_(umockdev_testbed_new()) {
    REQUIRE_MESSAGE(umockdev_in_mock_environment(), "run this program under umockdev-wrapper");
    ioctls_.reset(umockdev_ioctl_base_new());
    g_signal_connect(ioctls_.get(), "handle-ioctl", G_CALLBACK(handle_ioctl), this);
  }
  ~MockedMachine() {
    for (auto& [port, terminal] : terminals_) {
      umockdev_testbed_detach_ioctl(testbed_.get(), ("/dev/" + port).c_str(), nullptr);
      terminal.close();
    }
  }
  MockedMachine(const MockedMachine&) = delete;
  MockedMachine& operator=(const MockedMachine&) = delete;

  /// Plugs the device in, with a uevent for it and each of its parts, as the kernel does it.
  void plug(const MockedUsb& usb) {
    plug_usb(usb);
    if (!usb.port.empty()) plug_port(usb);
  }
  void plug_usb(const MockedUsb& usb) { add(usb_text(usb)); }
  void plug_port(const MockedUsb& usb) {
    // A node of umockdev's own could not come back after it was removed.
    const std::string node = "/dev/" + usb.port;
    Terminal& terminal = terminals_[usb.port];
    std::filesystem::create_symlink(terminal.open(), real(node));
    GError* error = nullptr;
    REQUIRE(umockdev_testbed_attach_ioctl(testbed_.get(), node.c_str(), ioctls_.get(), &error));
    add(port_text(usb));
    if (usb.driver == "ftdi_sio") {
      write("/sys/bus/usb-serial/devices/" + usb.port + "/latency_timer", "16\n");
    }
  }
  void unplug(const MockedUsb& usb) {
    if (!usb.port.empty()) unplug_port(usb);
    umockdev_testbed_uevent(testbed_.get(), usb.syspath().c_str(), "remove");
    remove(usb.syspath());
  }
  /// Closes the far end of a port.
  void hang_up(const std::string& port) { terminals_.at(port).close(); }

  int master(const std::string& port) const { return terminals_.at(port).master; }
  /// Makes a relative link, as udev does; umockdev's own links lead out of its mocked /dev.
  void link(const std::string& name, const std::string& port) const {
    const auto dev = real("/dev");
    const auto folder = (dev / name).parent_path();
    std::filesystem::create_directories(folder);
    std::filesystem::remove(dev / name);
    std::filesystem::create_symlink(std::filesystem::relative(dev, folder) / port, dev / name);
  }
  void write(const std::string& path, const std::string& text) const {
    std::filesystem::create_directories(real(path).parent_path());
    std::ofstream(real(path)) << text;
  }
  /// Returns the real place of a mocked path.
  std::filesystem::path real(const std::string& path) const {
    const std::unique_ptr<gchar, decltype(&g_free)> root(
        umockdev_testbed_get_root_dir(testbed_.get()), g_free);
    return std::filesystem::path(root.get()) / path.substr(1);
  }

  std::atomic<int> modem_lines{0}; ///< of all ports

private:
  /// The pseudo-terminal behind a port.
  struct Terminal {
    int master = -1;
    int slave = -1; ///< kept, so that it lives between two hosts

    std::string open() {
      master = ::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC);
      REQUIRE((master >= 0 && ::grantpt(master) == 0 && ::unlockpt(master) == 0));
      char name[128] = {};
      REQUIRE(::ptsname_r(master, name, sizeof name) == 0);
      slave = ::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC);
      termios settings{};
      ::tcgetattr(slave, &settings);
      ::cfmakeraw(&settings);
      ::tcsetattr(slave, TCSANOW, &settings);
      return name;
    }
    void close() {
      for (int* const end : {&slave, &master}) {
        if (*end >= 0) ::close(*end);
        *end = -1;
      }
    }
  };
  struct Unref {
    void operator()(gpointer object) const { g_object_unref(object); }
  };

  /// Handles the modem lines, which pseudo-terminals lack. They handle everything else themselves.
  static gboolean handle_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer machine) {
    constexpr int not_handled = -100; // umockdev: run it on the pseudo-terminal behind the mock
    auto& modem_lines = static_cast<MockedMachine*>(machine)->modem_lines;
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

  void add(const std::string& text) {
    GError* error = nullptr;
    const bool added = umockdev_testbed_add_from_string(testbed_.get(), text.c_str(), &error) != 0;
    REQUIRE_MESSAGE(added, (error != nullptr ? error->message : ""));
  }
  void unplug_port(const MockedUsb& usb) {
    const std::string node = "/dev/" + usb.port;
    umockdev_testbed_detach_ioctl(testbed_.get(), node.c_str(), nullptr);
    hang_up(usb.port);
    terminals_.erase(usb.port);
    std::filesystem::remove(real(node));
    remove(usb.tty_path());
    remove(usb.interface_path() + "/" + usb.port);
    remove(usb.interface_path());
    // umockdev leaves this file behind, and fails because of it when the name comes back.
    std::filesystem::remove(real("/sys/dev/char/188:" + usb.port.substr(usb.port.size() - 1)));
  }
  void remove(const std::string& syspath) {
    umockdev_testbed_remove_device(testbed_.get(), syspath.c_str());
    std::filesystem::remove_all(real(syspath));
  }

  static std::string usb_text(const MockedUsb& usb) {
    const std::string address = std::to_string(usb.address);
    const std::string three = std::string(3 - address.size(), '0') + address;
    const std::string serial = usb.serial.empty() ? "" : "A: serial=" + usb.serial + "\\n\n";
    return "P: " + usb.syspath().substr(4) + "\nN: bus/usb/001/" + three +
           "\nE: DEVNAME=/dev/bus/usb/001/" + three + "\nE: DEVTYPE=usb_device\nE: DRIVER=usb\n" +
           "E: SUBSYSTEM=usb\nE: BUSNUM=001\nE: DEVNUM=" + three +
           "\nE: MAJOR=189\nE: MINOR=" + std::to_string(usb.address - 1) +
           "\nA: busnum=1\\n\nA: devnum=" + address +
           "\\n\nA: speed=12\\n\nA: idVendor=" + usb.vendor_id +
           "\\n\nA: idProduct=" + usb.product_id + "\\n\nA: manufacturer=" + usb.manufacturer +
           "\\n\nA: product=" + usb.product + "\\n\n" + serial +
           "H: descriptors=" + descriptors(usb) + "\n";
  }
  /// Returns the device's 18 bytes, and a configuration with an interface without endpoints.
  static std::string descriptors(const MockedUsb& usb) {
    const auto little_endian = [](const std::string& hex) {
      return hex.substr(2, 2) + hex.substr(0, 2);
    };
    return "1201000200000008" + little_endian(usb.vendor_id) + little_endian(usb.product_id) +
           "000601020301" + "09021200010100a032" + "090400000000000000";
  }
  static std::string port_text(const MockedUsb& usb) {
    const std::string interface = usb.interface_path().substr(4);
    const std::string number = usb.port.substr(usb.port.find_first_of("0123456789"));
    return "P: " + interface + "\nE: DEVTYPE=usb_interface\nE: DRIVER=" + usb.driver +
           "\nE: SUBSYSTEM=usb\nA: bInterfaceNumber=00\\n\n\n" + "P: " + interface + "/" +
           usb.port + "\nE: DRIVER=" + usb.driver + "\nE: SUBSYSTEM=usb-serial\n" +
           "A: port_number=0\\n\n\n" + "P: " + usb.tty_path().substr(4) + "\nE: DEVNAME=/dev/" +
           usb.port + "\nE: MAJOR=188\nE: MINOR=" + number +
           "\nE: SUBSYSTEM=tty\nA: dev=188:" + number + "\\n\nL: device=../../../" + usb.port +
           "\n";
  }

  std::unique_ptr<UMockdevTestbed, Unref> testbed_;
  std::unique_ptr<UMockdevIoctlBase, Unref> ioctls_;
  std::map<std::string, Terminal> terminals_;
};

} // namespace nendo::test
