#include "transport/udev_devices.hpp"

#include <filesystem>
#include <string_view>
#include <system_error>

#include <nendo/base/number_in.hpp>

#include "transport/sysfs.hpp"

namespace nendo::driver {
namespace {

/// libudev may be used by several threads only if each has a context of its own.
::udev* this_threads_udev() {
  thread_local const UdevContext context(udev_new());
  return context.get();
}

} // namespace

std::vector<UdevDevice> list_udev_devices(const char* subsystem) {
  struct Unref {
    void operator()(udev_enumerate* list) const noexcept { udev_enumerate_unref(list); }
  };
  std::vector<UdevDevice> devices;
  ::udev* const context = this_threads_udev();
  const std::unique_ptr<udev_enumerate, Unref> list(udev_enumerate_new(context));
  if (!list || udev_enumerate_add_match_subsystem(list.get(), subsystem) < 0 ||
      udev_enumerate_scan_devices(list.get()) < 0)
    return devices;
  for (udev_list_entry* entry = udev_enumerate_get_list_entry(list.get()); entry != nullptr;
       entry = udev_list_entry_get_next(entry)) {
    UdevDevice device(udev_device_new_from_syspath(context, udev_list_entry_get_name(entry)));
    if (device) devices.push_back(std::move(device)); // otherwise it has gone meanwhile
  }
  return devices;
}

UdevDevice find_udev_device(const char* subsystem, const std::string& name) {
  return UdevDevice(
      udev_device_new_from_subsystem_sysname(this_threads_udev(), subsystem, name.c_str()));
}

bool udev_is_done_with(const char* subsystem, const std::string& node) {
  std::error_code failed;
  if (!std::filesystem::exists("/run/udev/data", failed)) return true; // udev does not run here
  const auto name = std::filesystem::path(node).filename().string();
  const UdevDevice device = find_udev_device(subsystem, name);
  return !device || udev_device_get_is_initialized(device.get()) != 0;
}

std::string attribute_of(udev_device& device, const char* name) {
  const char* const value = udev_device_get_sysattr_value(&device, name);
  if (value == nullptr) return {};
  const std::string_view text(value);
  return printable(text.substr(0, text.find('\n')));
}

std::optional<unsigned> number_of(udev_device& device, const char* name, int base) {
  return number_in<unsigned>(attribute_of(device, name), base);
}

bool has_flag(udev_device& device, const char* property) {
  const char* const value = udev_device_get_property_value(&device, property);
  return value != nullptr && std::string_view(value) == "1";
}

} // namespace nendo::driver
