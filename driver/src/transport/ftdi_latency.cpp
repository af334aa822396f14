#include "transport/ftdi_latency.hpp"

#include <filesystem>
#include <fstream>

#include <nendo/driver/devices.hpp>

#include "transport/open_transport.hpp"
#include "transport/sysfs.hpp"

namespace nendo::driver {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

/// Only ftdi_sio makes this file.
fs::path timer_file(const std::string& port) {
  return fs::path("/sys/bus/usb-serial/devices") / fs::path(resolve_port(port)).filename() /
         "latency_timer";
}

} // namespace

std::optional<milliseconds> ftdi_latency_timer(const std::string& port) {
  const auto latency_ms = read_number(timer_file(port));
  return latency_ms ? std::optional(milliseconds(*latency_ms)) : std::nullopt;
}

std::optional<milliseconds> shorten_ftdi_latency(const std::string& port) {
  const auto latency = ftdi_latency_timer(port);
  if (!latency || *latency <= milliseconds(1)) return latency;
  std::ofstream(timer_file(port)) << "1\n";
  return ftdi_latency_timer(port);
}

std::string latency_timer_remedy(const std::string& port) {
  return "echo 1 | sudo tee " + timer_file(port).string();
}

} // namespace nendo::driver
