#include "usb/usb_glove.hpp"

#include <utility>

namespace nendo::driver {

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

std::vector<GloveFact> facts_of(const UsbIdentity& identity) {
  std::vector<GloveFact> facts{{"usb_id", to_string(id_of(identity))},
                               {"usb_port", identity.place}};
  if (!identity.manufacturer.empty()) facts.push_back({"manufacturer", identity.manufacturer});
  if (!identity.product.empty()) facts.push_back({"product", identity.product});
  if (!identity.serial.empty()) facts.push_back({"serial", identity.serial});
  return facts;
}

} // namespace nendo::driver
