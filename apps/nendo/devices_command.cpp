// nendo devices: lists possible gloves and trackers, why they are listed, who may open them, and
// which programs use them. It opens none of them.

#include <array>
#include <chrono>
#include <ctime>
#include <iostream>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>
#include <spdlog/fmt/fmt.h>

#include <nendo/base/advised_command.hpp>
#include <nendo/driver/device_watcher.hpp>
#include <nendo/driver/devices.hpp>

#include "cli/cli.hpp"
#include "gloves/open_tracker.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::devices_command {
namespace {

using driver::DeviceCandidate;
using nlohmann::ordered_json;

struct Options {
  bool json = false;
  bool watch = false;
};

ordered_json json_of(const driver::UsbIdentity& usb) {
  return {{"vendor_id", fmt::format("{:04x}", usb.vendor_id)},
          {"product_id", fmt::format("{:04x}", usb.product_id)},
          {"manufacturer", usb.manufacturer},
          {"product", usb.product},
          {"serial", usb.serial},
          {"place", usb.place},
          {"bus", usb.bus},
          {"address", usb.address},
          {"interface", usb.interface_number}};
}

/// Returns the specifications by which the device can be tried as a tracker.
std::vector<std::string> tracker_specs_of(const DeviceCandidate& candidate) {
  if (!candidate.tracker_spec.empty()) return {candidate.tracker_spec};
  const bool is_glove = candidate.identified && !candidate.spec.empty();
  if (candidate.kind != driver::DeviceKind::serial_port || is_glove) return {};
  return gloves::tracker_specs_of_port(candidate.stable_name.empty() ? candidate.device
                                                                     : candidate.stable_name);
}

/// Returns an object with the same keys for every device. A value is null where a device has no
/// such thing.
ordered_json json_of(const DeviceCandidate& candidate) {
  ordered_json holders = ordered_json::array();
  for (const auto& holder : candidate.holders)
    holders.push_back({{"pid", holder.pid}, {"name", holder.name}});
  ordered_json line{{"device", candidate.device},
                    {"kind", driver::name_of(candidate.kind)},
                    {"stable_name", candidate.stable_name},
                    {"glove", candidate.spec},
                    {"trackers", tracker_specs_of(candidate)},
                    {"description", candidate.description},
                    {"reason", candidate.reason},
                    {"identified", candidate.identified},
                    {"may_open", candidate.may_open},
                    {"access", candidate.access},
                    {"remedy", candidate.remedy},
                    {"node_missing", candidate.node_missing}};
  line["usb"] = candidate.usb ? json_of(*candidate.usb) : ordered_json(nullptr);
  line["latency_timer_ms"] =
      candidate.latency_timer ? ordered_json(candidate.latency_timer->count()) : nullptr;
  line["left_alone"] = candidate.left_alone;
  line["holders"] = std::move(holders);
  line["holders_complete"] = candidate.holders_complete;
  return line;
}

void print_uses(const DeviceCandidate& candidate) {
  const auto trackers = tracker_specs_of(candidate);
  if (!candidate.spec.empty() || trackers.empty())
    std::cout << "\n  use it as  " << (candidate.spec.empty() ? "nothing yet" : candidate.spec);
  if (trackers.empty()) return;
  std::cout << (candidate.spec.empty() ? "\n  use it as  " : "\n  or as      ");
  for (const std::string& spec : trackers)
    std::cout << (&spec == &trackers.front() ? "" : ", ") << shell_word(spec);
  if (candidate.tracker_spec.empty()) std::cout << ", if it is a tracker";
  std::cout << ": `nendo doctor " << shell_word(trackers.front()) << "` tries it";
}

void print_text(const DeviceCandidate& candidate) {
  std::cout << candidate.device << ": " << candidate.description << "\n  why        "
            << candidate.reason;
  print_uses(candidate);
  if (candidate.node_missing) {
    std::cout << "\n  may open   no user: the kernel has it, but its device node is missing";
  } else {
    const std::string who =
        candidate.access.empty() ? "no user: it was unplugged" : candidate.access;
    std::cout << "\n  may open   "
              << (candidate.may_open || candidate.access.empty() ? "" : "only ") << who;
  }
  if (!candidate.remedy.empty()) std::cout << "\n  fix        " << candidate.remedy;
  for (const auto& holder : candidate.holders) {
    std::cout << "\n  used by    " << holder.name;
    if (holder.pid > 0) std::cout << " (pid " << holder.pid << ")";
    // Several programs may read the same input device; nendo takes it from them while it runs.
    if (candidate.kind != driver::DeviceKind::input_device)
      std::cout << "; close that program first";
  }
  std::cout << std::endl;
}

Result<void> list_devices(bool json) {
  const auto candidates = driver::find_devices();
  for (const auto& candidate : candidates)
    json ? cli::print_line(json_of(candidate)) : print_text(candidate);
  if (candidates.empty() && !json) {
    std::cout
        << "No serial port, USB device or input device can be a glove or a tracker. Plug one in, "
           "or use `sim`.\n";
  }
  return {};
}

std::string time_of_day(std::chrono::system_clock::time_point time) {
  const std::time_t seconds = std::chrono::system_clock::to_time_t(time);
  std::tm parts{};
  ::localtime_r(&seconds, &parts);
  std::array<char, 16> text{};
  std::strftime(text.data(), text.size(), "%H:%M:%S", &parts);
  return text.data();
}

void print_event(std::string_view event, const DeviceCandidate& candidate, bool json) {
  const auto now = std::chrono::system_clock::now();
  if (json) {
    const std::chrono::duration<double> since_epoch = now.time_since_epoch();
    ordered_json line{{"event", event}, {"unix_time_s", since_epoch.count()}};
    line.update(json_of(candidate));
    cli::print_line(line);
    return;
  }
  std::cout << time_of_day(now) << "  " << event << "  " << candidate.device << ": "
            << candidate.description;
  if (event != "detached") {
    const std::string& spec = candidate.spec.empty() ? candidate.tracker_spec : candidate.spec;
    if (!spec.empty()) std::cout << "; use it as " << shell_word(spec);
    if (!candidate.remedy.empty()) std::cout << "; first: " << candidate.remedy;
  }
  std::cout << std::endl;
}

Result<void> watch_devices(bool json) {
  using std::chrono::milliseconds;
  constexpr milliseconds max_wait{500}; // the signal may arrive just before the wait
  const auto watcher = driver::DeviceWatcher::open();
  if (!watcher) return watcher.error();
  cli::install_stop_signals();
  for (const auto& candidate : (*watcher)->present())
    print_event("present", candidate, json);
  if (!(*watcher)->sees_usb()) {
    cli::note(
        "USB cannot be watched here, only the nodes in /dev; gloves without a serial port are "
        "not noticed");
  }
  while (!cli::stop_requested()) {
    if (const auto event = (*watcher)->next(max_wait)) {
      print_event(event->attached ? "attached" : "detached", event->candidate, json);
    }
  }
  return {};
}

Result<void> devices(const Options& options) {
  return options.watch ? watch_devices(options.json) : list_devices(options.json);
}

} // namespace
} // namespace nendo::app::devices_command

void nendo::app::add_devices(cli::Command& program) {
  using namespace devices_command;
  cli::Command command = program.add_command(
      "devices", "Lists ports and devices that can be gloves or trackers, and why");
  Options& options = command.on_chosen<Options>(devices);
  command.add_flag("--json", options.json, "One JSON object per line");
  command.add_flag("--watch", options.watch,
                   "Then print a line when a device is plugged in or unplugged, until Ctrl-C");
}
