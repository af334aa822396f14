#include "discovery/udev_records.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <system_error>

#include "transport/sysfs.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;

// The format is udev's own and not promised, but unchanged since 2012; libudev reads it the same
// way. A line is a letter, a colon and a value; E is a property.
fs::path record_file(const std::string& device_number) {
  return "/run/udev/data/c" + device_number;
}

/// It becomes part of a path.
bool is_device_number(std::string_view text) {
  return !text.empty() && std::all_of(text.begin(), text.end(), [](unsigned char c) {
    return std::isdigit(c) != 0 || c == ':';
  });
}

} // namespace

bool tells_to_leave_alone(std::string_view record) {
  while (!record.empty()) {
    const std::string_view line = record.substr(0, record.find('\n'));
    if (line == "E:ID_MM_DEVICE_IGNORE=1" || line == "E:ID_MM_PORT_IGNORE=1") return true;
    record.remove_prefix(std::min(line.size() + 1, record.size()));
  }
  return false;
}

std::string udev_record(const std::string& device_number) {
  return is_device_number(device_number) ? read_text(record_file(device_number)) : std::string{};
}

bool udev_is_done_with(const std::string& device_number) {
  std::error_code failed;
  if (!is_device_number(device_number) || !fs::exists("/run/udev/data", failed)) return true;
  return fs::exists(record_file(device_number), failed);
}

} // namespace nendo::driver
