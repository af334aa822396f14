#include "transport/usb_transport.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include <libusb.h>

#include <nendo/base/units.hpp>

#include "discovery/programs.hpp"

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

/// At 8 ms between reports, as slow devices have it, 128 ms in which the reader may be busy.
constexpr std::size_t transfers_under_way = 16;
/// A pulled cable shows as bus errors until the hub has noticed it, and single errors happen to
/// good gloves: so many of them without a report between them are the end.
constexpr int max_errors_in_a_row = 64;
constexpr auto close_budget = 300ms;
constexpr auto idle_budget = 100ms;

// HID 1.11, 7.2: requests to an interface.
constexpr std::uint8_t to_interface = 0x21;
constexpr std::uint8_t from_interface = 0xA1;
constexpr std::uint8_t get_report = 0x01;
constexpr std::uint8_t set_report = 0x09;
constexpr std::uint8_t set_idle = 0x0A;
constexpr std::uint16_t feature = 0x0300;
/// SET_IDLE: send again after 100 ms (in units of 4 ms) what has not changed; all reports. The
/// kernel's driver sets it to never, and a hand at rest must not look like a dead glove.
constexpr std::uint16_t repeat_after_100_ms = 25U << 8U;

/// Outlives all devices, those of a list too.
using ContextHandle = std::shared_ptr<libusb_context>;

struct Closer {
  void operator()(libusb_device** list) const noexcept { libusb_free_device_list(list, 1); }
  void operator()(libusb_device_handle* device) const noexcept { libusb_close(device); }
  void operator()(libusb_transfer* transfer) const noexcept { libusb_free_transfer(transfer); }
  void operator()(libusb_config_descriptor* config) const noexcept {
    libusb_free_config_descriptor(config);
  }
};
using DeviceHandle = std::unique_ptr<libusb_device_handle, Closer>;

timeval to_timeval(HostClock::duration time) noexcept {
  const auto us =
      std::chrono::duration_cast<std::chrono::microseconds>(std::max(time, HostClock::duration{}));
  return {us.count() / 1'000'000, us.count() % 1'000'000};
}

unsigned to_timeout(std::chrono::milliseconds time) noexcept {
  return static_cast<unsigned>(std::clamp<long>(time.count(), 1, 60'000)); // 0 means: for ever
}

/// The interrupt endpoint that sends reports.
struct InputEndpoint {
  std::uint8_t address = 0;
  std::size_t packet_bytes = 0;
};

class LibusbTransport final : public UsbTransport {
public:
  LibusbTransport(ContextHandle context, DeviceHandle device, UsbIdentity identity,
                  int interface_number)
      : context_(std::move(context)), device_(std::move(device)), identity_(std::move(identity)),
        interface_(interface_number) {}
  ~LibusbTransport() override {
    cancel_all();
    libusb_release_interface(device_.get(), interface_); // the kernel's driver gets it back
    // Here, before the transfers are freed: libusb then forgets those that it could not cancel.
    device_.reset();
  }

  bool start(const InputEndpoint& endpoint, std::size_t report_bytes) {
    // Whole packets: a transfer ends with a short packet or when it is full, and a device that
    // sends more than was asked for in its last packet would be an error instead of a report to
    // judge.
    const std::size_t packets = (report_bytes + endpoint.packet_bytes - 1) / endpoint.packet_bytes;
    for (Slot& slot : slots_) {
      slot.owner = this;
      slot.data.resize(packets * endpoint.packet_bytes);
      slot.transfer.reset(libusb_alloc_transfer(0));
      if (!slot.transfer) return false;
      libusb_fill_interrupt_transfer(slot.transfer.get(), device_.get(), endpoint.address,
                                     slot.data.data(), static_cast<int>(slot.data.size()),
                                     on_transfer, &slot, 0);
      submit(slot);
    }
    return !gone_;
  }

  void ask_for_repeats() noexcept {
    control(to_interface, set_idle, repeat_after_100_ms, {}, idle_budget); // it need not know it
  }

  ReadResult read_some(std::span<std::byte> buffer,
                       std::chrono::milliseconds timeout) noexcept override {
    const HostTime deadline = HostClock::now() + timeout;
    for (;;) {
      if (Slot* const slot = take_arrived()) {
        const auto count = static_cast<std::size_t>(slot->transfer->actual_length);
        assert(count <= buffer.size());
        std::memcpy(buffer.data(), slot->data.data(), std::min(count, buffer.size()));
        submit(*slot);
        return {IoStatus::done, std::min(count, buffer.size())};
      }
      if (gone_) return {IoStatus::gone, 0};
      const auto left = deadline - HostClock::now();
      handle_events(left);
      if (left <= 0ms && arrived_count_ == 0 && !gone_) return {IoStatus::timeout, 0};
    }
  }

  IoStatus write_all(std::span<const std::byte> /*bytes*/,
                     std::chrono::milliseconds /*timeout*/) noexcept override {
    return gone_ ? IoStatus::gone : IoStatus::timeout;
  }
  void discard_input() noexcept override {
    handle_events({});
    // Only those that are here now: what each of them is submitted for is to come.
    for (std::size_t count = arrived_count_; count > 0; --count)
      submit(*take_arrived());
  }

  const UsbIdentity& identity() const noexcept override { return identity_; }
  ControlStatus get_feature(std::span<std::byte> report, std::size_t& received,
                            std::chrono::milliseconds timeout) noexcept override {
    assert(!report.empty());
    const auto value = static_cast<std::uint16_t>(feature | std::to_integer<unsigned>(report[0]));
    const std::span data(reinterpret_cast<unsigned char*>(report.data()), report.size());
    const int result = control(from_interface, get_report, value, data, timeout);
    received = result > 0 ? static_cast<std::size_t>(result) : 0;
    return status_of(result);
  }

  ControlStatus set_feature(std::span<const std::byte> report,
                            std::chrono::milliseconds timeout) noexcept override {
    assert(!report.empty() && report.size() <= max_usb_report_bytes);
    const auto value = static_cast<std::uint16_t>(feature | std::to_integer<unsigned>(report[0]));
    std::array<unsigned char, max_usb_report_bytes> copy{};
    const std::span data = std::span(copy).first(std::min(report.size(), copy.size()));
    std::memcpy(data.data(), report.data(), data.size());
    return status_of(control(to_interface, set_report, value, data, timeout));
  }

private:
  /// One transfer for ever: under way, or in `arrived_`, or given up.
  struct Slot {
    LibusbTransport* owner = nullptr;
    std::unique_ptr<libusb_transfer, Closer> transfer;
    std::vector<unsigned char> data;
  };

  static void on_transfer(libusb_transfer* transfer) noexcept {
    Slot& slot = *static_cast<Slot*>(transfer->user_data);
    slot.owner->finish(slot);
  }

  void finish(Slot& slot) noexcept {
    --under_way_;
    switch (slot.transfer->status) {
    case LIBUSB_TRANSFER_COMPLETED:
      errors_in_a_row_ = 0;
      if (slot.transfer->actual_length > 0) {
        arrived_[(first_arrived_ + arrived_count_++) % arrived_.size()] = &slot;
      } else {
        submit(slot);
      }
      break;
    case LIBUSB_TRANSFER_NO_DEVICE:
      gone_ = true;
      break;
    case LIBUSB_TRANSFER_CANCELLED:
      break;
    default: // one damaged on the bus, or refused by the device
      if (++errors_in_a_row_ >= max_errors_in_a_row) gone_ = true;
      submit(slot);
    }
  }

  void submit(Slot& slot) noexcept {
    if (gone_ || closing_) return;
    if (libusb_submit_transfer(slot.transfer.get()) == 0) {
      ++under_way_;
    } else {
      gone_ = true;
    }
  }

  void handle_events(HostClock::duration longest) noexcept {
    timeval time = to_timeval(longest);
    libusb_handle_events_timeout_completed(context_.get(), &time, nullptr);
  }

  /// A transfer may be freed when its callback has run; each runs once, cancelled or not.
  void cancel_all() noexcept {
    closing_ = true;
    for (Slot& slot : slots_) {
      if (slot.transfer) libusb_cancel_transfer(slot.transfer.get()); // if it is under way
    }
    const HostTime deadline = HostClock::now() + close_budget;
    while (under_way_ > 0 && HostClock::now() < deadline)
      handle_events(10ms);
  }

  Slot* take_arrived() noexcept {
    if (arrived_count_ == 0) return nullptr;
    --arrived_count_;
    Slot* const slot = arrived_[first_arrived_];
    first_arrived_ = (first_arrived_ + 1) % arrived_.size();
    return slot;
  }

  int control(std::uint8_t type, std::uint8_t request, std::uint16_t value,
              std::span<unsigned char> data, std::chrono::milliseconds timeout) noexcept {
    if (gone_ || data.size() > std::numeric_limits<std::uint16_t>::max()) return LIBUSB_ERROR_IO;
    const int result = libusb_control_transfer(
        device_.get(), type, request, value, static_cast<std::uint16_t>(interface_), data.data(),
        static_cast<std::uint16_t>(data.size()), to_timeout(timeout));
    if (result == LIBUSB_ERROR_NO_DEVICE) gone_ = true;
    return result;
  }

  ControlStatus status_of(int result) noexcept {
    if (gone_) return ControlStatus::gone;
    return result < 0 ? ControlStatus::refused : ControlStatus::done;
  }

  const ContextHandle context_;
  std::array<Slot, transfers_under_way> slots_; // outlives device_, see the destructor
  DeviceHandle device_;
  const UsbIdentity identity_;
  const int interface_;
  std::array<Slot*, transfers_under_way> arrived_{}; ///< oldest first, a ring
  std::size_t first_arrived_ = 0;
  std::size_t arrived_count_ = 0;
  int under_way_ = 0;
  int errors_in_a_row_ = 0;
  bool gone_ = false;
  bool closing_ = false;
};

UsbIdentity identify(libusb_device* device, UsbId id) {
  std::array<std::uint8_t, max_usb_ports> ports{};
  const int count = libusb_get_port_numbers(device, ports.data(), static_cast<int>(ports.size()));
  return identify_usb(id, libusb_get_bus_number(device), libusb_get_device_address(device),
                      std::span(ports).first(static_cast<std::size_t>(std::max(count, 0))));
}

Error open_failure(const UsbIdentity& identity, int result) {
  const std::string who = "USB device " + to_string(id_of(identity)) + " at " + node_of(identity);
  switch (result) {
  case LIBUSB_ERROR_ACCESS:
    return usb_permission_error(identity);
  case LIBUSB_ERROR_BUSY:
    return {Errc::no_device, who + " is in use by another program" + holder_of(node_of(identity)) +
                                 "; close that one first"};
  case LIBUSB_ERROR_NO_DEVICE:
    return {Errc::no_device, who + " went away; is the cable loose?"};
  case LIBUSB_ERROR_NOT_FOUND:
    return {Errc::no_device,
            who + " has not the interface of such a glove; `nendo devices` lists what is there"};
  default:
    return {Errc::no_device, who + " cannot be opened (" + libusb_error_name(result) +
                                 "); plug it in again, into another port if that does not help"};
  }
}

std::optional<InputEndpoint> input_of(const libusb_interface_descriptor& setting) {
  for (std::uint8_t k = 0; k < setting.bNumEndpoints; ++k) {
    const libusb_endpoint_descriptor& endpoint = setting.endpoint[k];
    const std::size_t packet_bytes = endpoint.wMaxPacketSize & 0x7FFU; // above are other things
    if ((endpoint.bmAttributes & 3) == LIBUSB_TRANSFER_TYPE_INTERRUPT &&
        (endpoint.bEndpointAddress & LIBUSB_ENDPOINT_IN) != 0 && packet_bytes > 0 &&
        packet_bytes <= max_usb_report_bytes)
      return InputEndpoint{endpoint.bEndpointAddress, packet_bytes};
  }
  return std::nullopt;
}

/// The input of an interface; nothing if it has none.
std::optional<InputEndpoint> find_input(libusb_device* device, int number) {
  libusb_config_descriptor* raw = nullptr;
  if (libusb_get_active_config_descriptor(device, &raw) != 0) return std::nullopt;
  const std::unique_ptr<libusb_config_descriptor, Closer> config(raw);
  for (std::uint8_t k = 0; k < raw->bNumInterfaces; ++k) {
    const libusb_interface& interface = raw->interface[k];
    if (interface.num_altsetting > 0 && interface.altsetting[0].bInterfaceNumber == number) {
      return input_of(interface.altsetting[0]);
    }
  }
  return std::nullopt;
}

Result<std::unique_ptr<UsbTransport>> open_device(const ContextHandle& context,
                                                  libusb_device* device,
                                                  const UsbIdentity& identity,
                                                  const UsbInterface& interface) {
  const auto input = find_input(device, interface.number);
  if (!input) return open_failure(identity, LIBUSB_ERROR_NOT_FOUND);
  libusb_device_handle* raw = nullptr;
  if (const int e = libusb_open(device, &raw); e != 0) return open_failure(identity, e);
  DeviceHandle handle(raw);
  libusb_set_auto_detach_kernel_driver(raw, 1); // and attach it again when it is released
  if (const int e = libusb_claim_interface(raw, interface.number); e != 0)
    return open_failure(identity, e);
  auto transport =
      std::make_unique<LibusbTransport>(context, std::move(handle), identity, interface.number);
  transport->ask_for_repeats();
  if (!transport->start(*input, interface.report_bytes))
    return open_failure(identity, LIBUSB_ERROR_NO_DEVICE);
  return std::unique_ptr<UsbTransport>(std::move(transport));
}

Error absent(const UsbWanted& wanted) {
  std::string what = "no USB device " + to_string(wanted.id);
  if (!wanted.serial.empty()) what += " with serial number " + wanted.serial;
  if (!wanted.port.empty()) what += " at port " + wanted.port;
  return {Errc::no_device, what + "; is the glove plugged in? `nendo devices` lists what is there"};
}

} // namespace

Result<std::unique_ptr<UsbTransport>> open_usb(const UsbWanted& wanted,
                                               const UsbInterface& interface) {
  libusb_context* raw = nullptr;
  if (libusb_init(&raw) != 0) return absent(wanted); // a machine without USB has no USB gloves
  const ContextHandle context(raw, libusb_exit);
  libusb_device** list = nullptr;
  const ssize_t count = libusb_get_device_list(raw, &list);
  const std::unique_ptr<libusb_device*, Closer> devices(count >= 0 ? list : nullptr);
  std::optional<Error> first_error;
  for (ssize_t k = 0; k < count; ++k) {
    libusb_device_descriptor descriptor{};
    if (libusb_get_device_descriptor(list[k], &descriptor) != 0) continue;
    if (UsbId{descriptor.idVendor, descriptor.idProduct} != wanted.id) continue;
    const UsbIdentity identity = identify(list[k], wanted.id);
    if (!wanted.serial.empty() && wanted.serial != identity.serial) continue;
    if (!wanted.port.empty() && wanted.port != identity.place) continue;
    auto opened = open_device(context, list[k], identity, interface);
    if (opened) return opened;
    if (!first_error) first_error = opened.error(); // another one of the kind may be free
  }
  return first_error ? *first_error : absent(wanted);
}

} // namespace nendo::driver
