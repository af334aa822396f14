#pragma once
// Input devices that umockdev makes of text: their entries in /sys, nodes in /dev/input, and the
// ioctls of linux/input.h. The program must run under umockdev-wrapper.

#include <atomic>
#include <cstring>
#include <filesystem>
#include <map>
#include <memory>
#include <string>

#include <doctest/doctest.h>
#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>
#include <termios.h>
#include <umockdev.h>
#include <unistd.h>

#include <nendo/base/unique_fd.hpp>

namespace nendo::test {

struct MockedInput {
  int number = 5; ///< its node is event5
  std::string name = "3Dconnexion SpaceNavigator";
  std::string properties = "0";
  std::string keys = "3 0 0 0 0"; ///< with words of 64 bits
  std::string relative = "0";
  std::string absolute = "3f";
  std::string vendor_id = "046d";
  std::string product_id = "c626";

  std::string node() const { return "/dev/input/event" + std::to_string(number); }
  std::string parent() const { return "/devices/virtual/input/input" + std::to_string(number); }
};

class MockedInputs {
public:
  MockedInputs() : testbed_(umockdev_testbed_new()), ioctls_(umockdev_ioctl_base_new()) {
    REQUIRE_MESSAGE(umockdev_in_mock_environment(), "run this program under umockdev-wrapper");
    g_signal_connect(ioctls_.get(), "handle-ioctl", G_CALLBACK(handle_ioctl), this);
  }
  ~MockedInputs() {
    for (const auto& [number, terminal] : terminals_)
      umockdev_testbed_detach_ioctl(testbed_.get(), MockedInput{number}.node().c_str(), nullptr);
  }
  MockedInputs(const MockedInputs&) = delete;
  MockedInputs& operator=(const MockedInputs&) = delete;

  void plug(const MockedInput& input) {
    const std::string node = input.node();
    std::filesystem::create_directories(real(node).parent_path());
    std::filesystem::create_symlink(terminals_[input.number].open(), real(node));
    GError* error = nullptr;
    REQUIRE(umockdev_testbed_attach_ioctl(testbed_.get(), node.c_str(), ioctls_.get(), &error));
    const std::string text =
        "P: " + input.parent() + "\nE: SUBSYSTEM=input\nA: name=" + input.name +
        "\\n\nA: properties=" + input.properties + "\\n\nA: capabilities/key=" + input.keys +
        "\\n\nA: capabilities/rel=" + input.relative +
        "\\n\nA: capabilities/abs=" + input.absolute +
        "\\n\nA: id/bustype=0003\\n\nA: id/vendor=" + input.vendor_id +
        "\\n\nA: id/product=" + input.product_id + "\\n\n\nP: " + input.parent() + "/event" +
        std::to_string(input.number) + "\nE: DEVNAME=" + node +
        "\nE: SUBSYSTEM=input\nL: device=../../input" + std::to_string(input.number) + "\n";
    const bool added = umockdev_testbed_add_from_string(testbed_.get(), text.c_str(), &error) != 0;
    REQUIRE_MESSAGE(added, (error != nullptr ? error->message : ""));
  }
  void unplug(const MockedInput& input) {
    umockdev_testbed_detach_ioctl(testbed_.get(), input.node().c_str(), nullptr);
    terminals_.erase(input.number);
    std::filesystem::remove(real(input.node()));
    const std::string syspath = "/sys" + input.parent();
    const std::string child = syspath + "/event" + std::to_string(input.number);
    for (const std::string& path : {child, syspath}) {
      umockdev_testbed_remove_device(testbed_.get(), path.c_str());
      std::filesystem::remove_all(real(path));
    }
  }
  /// Sends an event, and the end of its report.
  void send(const MockedInput& input, int type, int code, int value) const {
    for (const input_event& event : {event_of(type, code, value), event_of(EV_SYN, SYN_REPORT, 0)})
      REQUIRE(::write(terminals_.at(input.number).master.get(), &event, sizeof event) ==
              sizeof event);
  }
  /// Makes a link, e.g. "by-id/usb-X-event-mouse", as udev does.
  void link(const std::string& name, const MockedInput& input) const {
    const auto link = real("/dev/input/" + name);
    std::filesystem::create_directories(link.parent_path());
    std::filesystem::create_symlink("../event" + std::to_string(input.number), link);
  }
  std::filesystem::path real(const std::string& path) const {
    const std::unique_ptr<gchar, decltype(&g_free)> root(
        umockdev_testbed_get_root_dir(testbed_.get()), g_free);
    return std::filesystem::path(root.get()) / path.substr(1);
  }

  std::atomic<int> axis_value{0};   ///< what all axes have, whose range is from -350 to 350
  std::atomic<bool> grabbed{false}; ///< the program under test has it
  std::atomic<bool> grabbed_elsewhere{false};

private:
  /// The pseudo-terminal behind a node.
  struct Terminal {
    UniqueFd master;
    UniqueFd slave; ///< kept, so that it lives between two hosts

    std::string open() {
      master = UniqueFd(::posix_openpt(O_RDWR | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
      const int fd = master.get();
      REQUIRE((fd >= 0 && ::grantpt(fd) == 0 && ::unlockpt(fd) == 0));
      char name[128] = {};
      REQUIRE(::ptsname_r(fd, name, sizeof name) == 0);
      slave = UniqueFd(::open(name, O_RDWR | O_NOCTTY | O_CLOEXEC));
      termios settings{};
      ::tcgetattr(slave.get(), &settings);
      ::cfmakeraw(&settings);
      ::tcsetattr(slave.get(), TCSANOW, &settings);
      return name;
    }
  };
  struct Unref {
    void operator()(gpointer object) const { g_object_unref(object); }
  };

  static input_event event_of(int type, int code, int value) {
    input_event event{};
    event.type = static_cast<__u16>(type);
    event.code = static_cast<__u16>(code);
    event.value = value;
    return event;
  }

  static gboolean handle_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer inputs) {
    constexpr int not_handled = -100; // umockdev: run it on the pseudo-terminal behind the mock
    auto& self = *static_cast<MockedInputs*>(inputs);
    const auto request = umockdev_ioctl_client_get_request(client);
    UMockdevIoctlData* argument = umockdev_ioctl_client_get_arg(client);
    if (request == EVIOCGRAB) {
      std::intptr_t wanted = 0;
      std::memcpy(&wanted, argument->data, sizeof wanted);
      if (!self.grabbed_elsewhere) self.grabbed = wanted != 0;
      umockdev_ioctl_client_complete(client, self.grabbed_elsewhere ? -1 : 0, EBUSY);
    } else if (request >= EVIOCGABS(0) && request < EVIOCGABS(ABS_CNT)) {
      UMockdevIoctlData* value =
          umockdev_ioctl_data_resolve(argument, 0, sizeof(input_absinfo), nullptr);
      const input_absinfo info{self.axis_value, -350, 350, 0, 0, 0};
      std::memcpy(value->data, &info, sizeof info);
      umockdev_ioctl_client_complete(client, 0, 0);
    } else {
      umockdev_ioctl_client_complete(client, not_handled, 0);
    }
    return TRUE;
  }

  std::unique_ptr<UMockdevTestbed, Unref> testbed_;
  std::unique_ptr<UMockdevIoctlBase, Unref> ioctls_;
  std::map<int, Terminal> terminals_;
};

} // namespace nendo::test
