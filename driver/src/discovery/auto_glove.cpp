#include <string>

#include <nendo/driver/glove_options.hpp>

#include "cyberglove/cyberglove_driver.hpp"
#include "discovery/candidates.hpp"
#include "drivers.hpp"

namespace nendo::driver {
namespace {

using namespace std::chrono_literals;

/// nullopt: either hand will do.
Result<std::optional<Side>> wanted_side(const DeviceSpec& spec, std::optional<Side> side) {
  if (spec.target.empty()) return side;
  for (const Side known : {Side::left, Side::right}) {
    if (spec.target == name_of(known)) return std::optional(known);
  }
  return Error{Errc::usage, spec.text + ": after auto: comes left or right, not " + spec.target};
}

} // namespace

Result<std::unique_ptr<Glove>> open_auto(const DeviceSpec& spec, std::optional<Side> side) {
  if (auto allowed = allow_options(spec, {}); !allowed) return allowed.error();
  const auto wanted = wanted_side(spec, side);
  if (!wanted) return wanted.error();
  const HostTime deadline = HostClock::now() + 4500ms;
  std::string why;
  Errc code = Errc::no_device;
  for (const DeviceCandidate& candidate : list_candidates()) {
    if (!candidate.identified || candidate.spec.empty()) continue;
    const auto parsed = parse_device_spec(candidate.spec);
    if (!parsed || HostClock::now() >= deadline) continue;
    auto glove = candidate.kind == DeviceKind::serial_port
                     ? cyberglove::open_serial_by(*parsed, deadline)
                     : open_usb_glove_by(*parsed, deadline);
    if (glove && (!*wanted || (*glove)->info().side == **wanted)) return glove;
    if (!glove && glove.error().code == Errc::no_permission) code = Errc::no_permission;
    why += glove ? candidate.spec + " is a " + std::string(name_of((*glove)->info().side)) + " hand"
                 : glove.error().message;
    why += "; ";
  }
  if (why.empty()) why = "no port is known to be a glove's; ";
  const std::string hand = *wanted ? std::string(name_of(**wanted)) + " " : "";
  return Error{code, spec.text + ": no " + hand + "glove found: " + why +
                         "name the port, e.g. serial:/dev/ttyUSB0 (`nendo devices` lists them)"};
}

} // namespace nendo::driver
