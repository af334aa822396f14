// Input devices of the kernel, which can be trackers.

#include <algorithm>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "discovery/candidates.hpp"
#include "evdev/input_device.hpp"
#include "transport/sysfs.hpp"
#include "transport/usb_identity.hpp"

namespace nendo::driver {
namespace {

using evdev::InputDevice;

/// Returns udev's links to input devices, by node. Links by maker, model and serial number come
/// before those by place.
std::map<std::string, std::string> find_input_links() {
  std::map<std::string, std::string> links;
  for (const std::string folder : {"/dev/input/by-id/", "/dev/input/by-path/"}) {
    std::vector<std::string> names = names_in(folder);
    std::sort(names.begin(), names.end()); // so that it is always the same one of several
    for (const std::string& name : names)
      links.emplace(evdev::resolve_input(folder + name), folder + name);
  }
  return links;
}

DeviceCandidate candidate_of(const InputDevice& device, const std::vector<InputDevice>& all,
                             std::string link) {
  DeviceCandidate candidate;
  candidate.kind = DeviceKind::input_device;
  candidate.device = device.node;
  candidate.tracker_spec = "evdev:" + name_to_type(device, all, link);
  candidate.stable_name = std::move(link);
  candidate.description = (device.name.empty() ? "input device without a name" : device.name) +
                          ", " + std::string(name_of(device.kind));
  candidate.identified = is_space_mouse(device);
  candidate.reason = candidate.identified
                         ? "its numbers and axes are those of a SpaceMouse"
                         : "may be a tracker: " + std::string(name_of(device.kind));
  if (device.is_usb) candidate.usb = usb_identity_of("input", device.node);
  set_access(candidate, input_access(device));
  return candidate;
}

} // namespace

std::vector<DeviceCandidate> list_input_candidates() {
  const std::vector<InputDevice> devices = evdev::list_input_devices();
  const auto links = find_input_links();
  std::vector<DeviceCandidate> candidates;
  for (const InputDevice& device : devices) {
    const auto link = links.find(device.node);
    candidates.push_back(
        candidate_of(device, devices, link != links.end() ? link->second : std::string{}));
  }
  return candidates;
}

} // namespace nendo::driver
