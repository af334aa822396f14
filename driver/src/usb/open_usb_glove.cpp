#include <algorithm>
#include <array>
#include <cstdint>
#include <string>
#include <utility>

#include <nendo/base/number_in.hpp>
#include <nendo/udev/device_table.hpp>

#include "drivers.hpp"
#include "fivedt_usb/fivedt_usb_parser.hpp"
#include "p5/p5_parser.hpp"
#include "stream/stream_glove.hpp"
#include "transport/usb_transport.hpp"
#include "usb/usb_glove.hpp"

namespace nendo::driver {
namespace {

/// All gloves of a maker have one driver.
struct UsbDriver {
  std::uint16_t vendor;
  Result<std::unique_ptr<Glove>> (*open)(const DeviceSpec& spec, const UsbWanted& wanted,
                                         HostTime deadline);
};

constexpr std::array usb_drivers{
    UsbDriver{p5::usb_id.vendor, p5::open_p5},
    UsbDriver{fivedt_usb::vendor_id, fivedt_usb::open_fivedt_usb},
};

const UsbDriver* find_driver(UsbId id) noexcept {
  if (udev::usb_glove_name(id).empty()) return nullptr;
  const auto* const found =
      std::find_if(usb_drivers.begin(), usb_drivers.end(),
                   [&](const UsbDriver& driver) { return driver.vendor == id.vendor; });
  return found != usb_drivers.end() ? found : nullptr;
}

/// Four hexadecimal digits.
std::optional<std::uint16_t> read_number(std::string_view text) noexcept {
  return text.size() == 4 ? number_in<std::uint16_t>(text, 16) : std::nullopt;
}

Result<UsbId> id_of(const DeviceSpec& spec) {
  const std::string_view target = spec.target;
  const std::size_t colon = target.find(':');
  const auto vendor = read_number(target.substr(0, colon));
  const auto product =
      colon == std::string_view::npos ? std::nullopt : read_number(target.substr(colon + 1));
  if (vendor && product) return UsbId{*vendor, *product};
  return Error{Errc::usage, spec.text + ": after usb: come the vendor's and the product's number, "
                                        "four hexadecimal digits each, e.g. usb:0d7f:0100"};
}

Error unknown(const DeviceSpec& spec) {
  std::string known;
  const auto models = udev::usb_glove_models();
  for (std::size_t first = 0, next = 0; first < models.size(); first = next) {
    while (next < models.size() && models[next].name == models[first].name)
      ++next;
    known += (known.empty() ? "" : ", ") + to_string(models[first].id);
    if (next - first > 1) known += " to " + to_string(models[next - 1].id);
    known.append(" (").append(models[first].name) += ')';
  }
  return {Errc::usage, spec.text + ": no driver for this USB device; known: " + known};
}

} // namespace

Result<std::unique_ptr<Glove>> open_usb_glove_by(const DeviceSpec& spec, HostTime deadline) {
  const auto id = id_of(spec);
  if (!id) return id.error();
  const UsbDriver* const driver = find_driver(*id);
  if (driver == nullptr) return unknown(spec);
  UsbWanted wanted{*id, {}, {}};
  if (const auto serial = spec.options.find("serial"); serial != spec.options.end())
    wanted.serial = serial->second;
  return driver->open(spec, wanted, deadline);
}

Result<std::unique_ptr<Glove>> open_usb_glove(const DeviceSpec& spec,
                                              std::optional<Side> /*side*/) {
  return open_usb_glove_by(spec, HostClock::now() + open_budget);
}

OpenPort usb_opener(UsbWanted wanted, const UsbInterface& interface) {
  return [last = std::move(wanted), interface]() mutable -> Result<std::unique_ptr<Transport>> {
    auto opened = open_usb(last, interface);
    if (!opened) return opened.error();
    const UsbIdentity& identity = (*opened)->identity();
    last.serial = identity.serial;
    last.port = identity.serial.empty() ? identity.place : std::string{};
    return std::unique_ptr<Transport>(*std::move(opened));
  };
}

std::vector<DeviceFact> facts_of(const UsbIdentity& identity) {
  std::vector<DeviceFact> facts{{"usb_id", to_string(id_of(identity))},
                                {"usb_port", identity.place}};
  if (!identity.manufacturer.empty()) facts.push_back({"manufacturer", identity.manufacturer});
  if (!identity.product.empty()) facts.push_back({"product", identity.product});
  if (!identity.serial.empty()) facts.push_back({"serial", identity.serial});
  return facts;
}

} // namespace nendo::driver
