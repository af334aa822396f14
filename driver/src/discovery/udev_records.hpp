#pragma once
// What udev's rules found out about a device, from the records that it keeps for other programs.

#include <string>
#include <string_view>

namespace nendo::driver {

/// True if a record of udev's tells ModemManager to leave the device alone.
bool tells_to_leave_alone(std::string_view record);

/// The record of a character device, e.g. "188:0"; empty if there is none (yet).
std::string udev_record(const std::string& device_number);

/// True if udev is done with the device, or does not run here at all.
bool udev_is_done_with(const std::string& device_number);

} // namespace nendo::driver
