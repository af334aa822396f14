#include "support/mocked_usb.hpp"

#include <array>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <deque>
#include <stdexcept>
#include <thread>

#include <linux/usbdevice_fs.h>
#include <sys/ioctl.h>
#include <umockdev.h>

namespace nendo::test {
namespace mocked_usb { // not anonymous: MockedUsb::Device, which a header names, has members of
                       // these

using Clock = std::chrono::steady_clock;
using namespace std::chrono_literals;

constexpr auto report_period = 2ms;

struct Unref {
  void operator()(gpointer object) const { g_object_unref(object); }
};
using Data = std::unique_ptr<UMockdevIoctlData, Unref>;

/// A copy of the client's memory, written back when the call is over.
Data resolve(UMockdevIoctlData* data, std::size_t offset, std::size_t bytes) {
  return Data(umockdev_ioctl_data_resolve(data, offset, bytes, nullptr));
}

struct Urb {
  UMockdevIoctlClient* client;
  Data header;
  Data buffer;
  Clock::time_point due;
  bool finished = false;

  usbdevfs_urb& operator*() const { return *reinterpret_cast<usbdevfs_urb*>(header->data); }
  bool is_control() const { return (**this).type == USBDEVFS_URB_TYPE_CONTROL; }
  void finish(int status, std::size_t bytes) {
    (**this).status = status;
    (**this).actual_length = static_cast<int>(bytes);
    finished = true;
  }
};

std::string hex(const UsbBytes& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    std::array<char, 3> digits{};
    std::snprintf(digits.data(), digits.size(), "%02x", unsigned{byte});
    text += digits.data();
  }
  return text;
}

} // namespace mocked_usb

using namespace mocked_usb;

struct MockedUsb::Device {
  Device(UsbGlove& model, std::string sys_path, std::string dev_node)
      : glove(model), path(std::move(sys_path)), node(std::move(dev_node)) {}

  UsbGlove& glove;
  const std::string path;
  const std::string node;
  std::unique_ptr<UMockdevIoctlBase, Unref> ioctls{umockdev_ioctl_base_new()};
  std::mutex mutex; ///< guards what follows, and the glove
  UsbLog log;
  std::deque<Urb> urbs;
  UMockdevIoctlClient* owner = nullptr; ///< who has claimed the glove's interface
  UsbBytes rest;                        ///< of a report that was longer than the transfer
  Clock::time_point next_report{};
  int spoilt = 0;
  bool send_nothing = false;
  bool gone = false;

  unsigned glove_interface() const { return glove.interfaces - 1U; }
  int claim(UMockdevIoctlClient* client, unsigned interface, bool detach);
  void release(UMockdevIoctlClient* client);
  int reattach(unsigned interface);
  void submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  void answer_control(Urb& urb);
  void advance();
  void fill(Urb& urb, Clock::time_point now);
  int reap(UMockdevIoctlClient* client, UMockdevIoctlData* argument);
  int discard(UMockdevIoctlData* argument);
  int handle(UMockdevIoctlClient* client, unsigned request, UMockdevIoctlData* argument);
  void forget(UMockdevIoctlClient* client);
};

int MockedUsb::Device::claim(UMockdevIoctlClient* client, unsigned interface, bool detach) {
  if (interface != glove_interface()) {
    log.kernel_has_mouse = false;
    return 0;
  }
  if (owner != nullptr && owner != client) return EBUSY;
  if (log.kernel_has_glove && !detach) return EBUSY;
  if (std::exchange(log.kernel_has_glove, false)) ++log.detached;
  owner = client;
  log.claimed = true;
  return 0;
}

void MockedUsb::Device::release(UMockdevIoctlClient* client) {
  if (owner != client) return;
  owner = nullptr;
  log.claimed = false;
}

int MockedUsb::Device::reattach(unsigned interface) {
  if (interface != glove_interface() || log.claimed) return EBUSY;
  if (!std::exchange(log.kernel_has_glove, true)) ++log.attached;
  return 0;
}

void MockedUsb::Device::submit(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  Data header = resolve(argument, 0, sizeof(usbdevfs_urb));
  const auto& urb = *reinterpret_cast<usbdevfs_urb*>(header->data);
  Data buffer = resolve(header.get(), G_STRUCT_OFFSET(usbdevfs_urb, buffer),
                        static_cast<std::size_t>(urb.buffer_length));
  urbs.push_back({client, std::move(header), std::move(buffer), Clock::now()});
  if (urbs.back().is_control()) {
    answer_control(urbs.back());
  } else {
    log.max_under_way = std::max(log.max_under_way, ++log.under_way);
  }
}

/// HID 1.11, 7.2: GET_REPORT, SET_REPORT and SET_IDLE of the glove's interface; others stall.
void MockedUsb::Device::answer_control(Urb& urb) {
  std::uint8_t* const data = urb.buffer->data;
  const UsbBytes setup(data, data + 8);
  log.controls.push_back(setup);
  const std::size_t length = setup[6] + 256U * setup[7];
  const bool to_glove = setup[4] == glove_interface() && setup[5] == 0;
  const bool is_feature = setup[3] == 3 && to_glove;
  if (setup[0] == 0xA1 && setup[1] == 0x01 && is_feature) {
    if (const auto report = glove.get_feature(setup[2])) {
      const std::size_t count = std::min(length, report->size());
      std::memcpy(data + 8, report->data(), count);
      return urb.finish(0, count);
    }
  } else if (setup[0] == 0x21 && setup[1] == 0x09 && is_feature) {
    const UsbBytes report(data + 8, data + 8 + length);
    if (!report.empty() && report[0] == setup[2] && glove.set_feature(report))
      return urb.finish(0, length);
  } else if (setup[0] == 0x21 && setup[1] == 0x0A && to_glove) {
    return urb.finish(0, 0);
  }
  urb.finish(-EPIPE, 0);
}

/// What the bus and the glove did meanwhile.
void MockedUsb::Device::advance() {
  // One moment for all: a report that came due between two looks would go to the younger transfer.
  const Clock::time_point now = Clock::now();
  for (Urb& urb : urbs) {
    if (gone && !urb.finished) urb.finish(-ESHUTDOWN, 0);
    if (urb.finished || now < next_report) continue;
    fill(urb, now);
  }
}

/// A transfer takes whole packets until one is short or it is full (USB 2.0, 5.3.2).
void MockedUsb::Device::fill(Urb& urb, Clock::time_point now) {
  if (spoilt > 0) {
    --spoilt;
    return urb.finish(-EILSEQ, 0);
  }
  if (std::exchange(send_nothing, false)) return urb.finish(0, 0);
  if (rest.empty()) {
    const auto report = glove.next_report();
    if (!report) return;
    rest = *report;
    next_report = std::max(next_report + report_period, now);
  }
  const auto space = static_cast<std::size_t>((*urb).buffer_length);
  const std::size_t count = std::min(space, rest.size());
  std::memcpy(urb.buffer->data, rest.data(), count);
  rest.erase(rest.begin(), rest.begin() + static_cast<std::ptrdiff_t>(count));
  const bool overflow = !rest.empty() && space % glove.packet_bytes != 0;
  if (overflow) rest.clear();
  urb.finish(overflow ? -EOVERFLOW : 0, count);
}

int MockedUsb::Device::reap(UMockdevIoctlClient* client, UMockdevIoctlData* argument) {
  advance();
  for (auto urb = urbs.begin(); urb != urbs.end(); ++urb) {
    if (!urb->finished || urb->client != client) continue;
    if (!urb->is_control()) --log.under_way;
    const Data place = resolve(argument, 0, sizeof(gpointer));
    umockdev_ioctl_data_set_ptr(place.get(), 0, urb->header.get());
    urbs.erase(urb);
    return 0;
  }
  return gone ? ENODEV : EAGAIN;
}

int MockedUsb::Device::discard(UMockdevIoctlData* argument) {
  gulong address = 0;
  std::memcpy(&address, argument->data, sizeof address);
  for (Urb& urb : urbs) {
    if (urb.header->client_addr != address || urb.finished) continue;
    urb.finish(-ENOENT, 0);
    return 0;
  }
  return EINVAL;
}

/// An error number, 0 if it worked.
int MockedUsb::Device::handle(UMockdevIoctlClient* client, unsigned request,
                              UMockdevIoctlData* argument) {
  const auto number = [&] {
    unsigned value = 0;
    std::memcpy(&value, resolve(argument, 0, sizeof value)->data, sizeof value);
    return value;
  };
  if (request == USBDEVFS_REAPURBNDELAY) return reap(client, argument);
  if (request == USBDEVFS_DISCARDURB) return discard(argument);
  if (gone) return ENODEV;
  switch (request) {
  case USBDEVFS_GET_CAPABILITIES: {
    const unsigned capabilities = USBDEVFS_CAP_NO_PACKET_SIZE_LIM | USBDEVFS_CAP_BULK_CONTINUATION;
    const Data place = resolve(argument, 0, sizeof capabilities);
    std::memcpy(place->data, &capabilities, sizeof capabilities);
    return 0;
  }
  case USBDEVFS_CLAIMINTERFACE:
    return claim(client, number(), false);
  case USBDEVFS_DISCONNECT_CLAIM:
    return claim(client, number(), true); // the interface comes first
  case USBDEVFS_RELEASEINTERFACE:
    release(client);
    return 0;
  case USBDEVFS_IOCTL: {
    const Data place = resolve(argument, 0, sizeof(usbdevfs_ioctl));
    const auto& inner = *reinterpret_cast<usbdevfs_ioctl*>(place->data);
    if (static_cast<unsigned>(inner.ioctl_code) != USBDEVFS_CONNECT) return ENOTTY;
    return reattach(static_cast<unsigned>(inner.ifno));
  }
  case USBDEVFS_SUBMITURB:
    submit(client, argument);
    return 0;
  default:
    return ENOTTY;
  }
}

void MockedUsb::Device::forget(UMockdevIoctlClient* client) {
  release(client);
  std::erase_if(urbs, [&](const Urb& urb) {
    if (urb.client != client) return false;
    if (!urb.is_control()) --log.under_way;
    return true;
  });
}

namespace {

gboolean on_ioctl(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  auto& device = *static_cast<MockedUsb::Device*>(user);
  int error = 0;
  {
    const std::lock_guard lock(device.mutex);
    error = device.handle(client, static_cast<unsigned>(umockdev_ioctl_client_get_request(client)),
                          umockdev_ioctl_client_get_arg(client));
  }
  umockdev_ioctl_client_complete(client, error == 0 ? 0 : -1, error);
  return TRUE;
}

void on_vanished(UMockdevIoctlBase*, UMockdevIoctlClient* client, gpointer user) {
  auto& device = *static_cast<MockedUsb::Device*>(user);
  const std::lock_guard lock(device.mutex);
  device.forget(client);
}

void require(bool worked, const GError* error) {
  if (!worked) throw std::runtime_error(error != nullptr ? error->message : "umockdev");
}

} // namespace

MockedUsb::MockedUsb() : testbed_(umockdev_testbed_new()) {
  if (umockdev_in_mock_environment() == FALSE)
    throw std::runtime_error("run this program under umockdev-wrapper");
}

MockedUsb::~MockedUsb() {
  for (const auto& device : devices_) {
    if (!device->gone) unplug(*device);
  }
  g_object_unref(testbed_);
}

MockedUsb::Device& MockedUsb::plug(UsbGlove& glove, int port, int address,
                                   const std::string& serial) {
  std::array<char, 1024> text{};
  std::snprintf(text.data(), text.size(), R"(P: /devices/pci0000:00/0000:00:14.0/usb1/1-%d
N: bus/usb/001/%03d
E: DEVNAME=/dev/bus/usb/001/%03d
E: DEVTYPE=usb_device
E: DRIVER=usb
E: SUBSYSTEM=usb
E: BUSNUM=001
E: DEVNUM=%03d
E: MAJOR=189
E: MINOR=%d
A: busnum=1\n
A: devnum=%d\n
A: bConfigurationValue=1\n
A: speed=12\n
A: idVendor=%04x\n
A: idProduct=%04x\n
A: manufacturer=a maker%c of gloves\n
A: product=a glove\n
%s%s%sH: descriptors=%s
)",
                port, address, address, address, address - 1, address, unsigned{glove.vendor},
                unsigned{glove.product}, 0x1B, serial.empty() ? "" : "A: serial=", serial.c_str(),
                serial.empty() ? "" : "\\n\n", hex(glove.descriptors()).c_str());
  std::array<char, 64> node{};
  std::snprintf(node.data(), node.size(), "/dev/bus/usb/001/%03d", address);
  devices_.push_back(std::make_unique<Device>(
      glove, "/sys/devices/pci0000:00/0000:00:14.0/usb1/1-" + std::to_string(port), node.data()));
  Device& device = *devices_.back();
  GError* error = nullptr;
  require(umockdev_testbed_add_from_string(testbed_, text.data(), &error) == TRUE, error);
  g_signal_connect(device.ioctls.get(), "handle-ioctl", G_CALLBACK(on_ioctl), &device);
  g_signal_connect(device.ioctls.get(), "client-vanished", G_CALLBACK(on_vanished), &device);
  require(umockdev_testbed_attach_ioctl(testbed_, node.data(), device.ioctls.get(), &error) == TRUE,
          error);
  return device;
}

void MockedUsb::unplug(Device& device) {
  {
    const std::lock_guard lock(device.mutex);
    device.gone = true;
  }
  // umockdev aborts if a listener closes its socket just then, and a driver whose transfers fail
  // does close it.
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  umockdev_testbed_uevent(testbed_, device.path.c_str(), "remove");
  umockdev_testbed_remove_device(testbed_, device.path.c_str());
  umockdev_testbed_detach_ioctl(testbed_, device.node.c_str(), nullptr);
}

UsbLog MockedUsb::log_of(Device& device) {
  const std::lock_guard lock(device.mutex);
  return device.log;
}

void MockedUsb::spoil(Device& device, int transfers) {
  const std::lock_guard lock(device.mutex);
  device.spoilt = transfers;
}

void MockedUsb::send_nothing(Device& device) {
  const std::lock_guard lock(device.mutex);
  device.send_nothing = true;
}

std::string MockedUsb::root() const {
  const std::unique_ptr<gchar, decltype(&g_free)> root(umockdev_testbed_get_root_dir(testbed_),
                                                       g_free);
  return root.get();
}

std::string MockedUsb::node_file(const Device& device) const {
  return root() + device.node;
}

std::mutex& MockedUsb::mutex_of(Device& device) {
  return device.mutex;
}

} // namespace nendo::test
