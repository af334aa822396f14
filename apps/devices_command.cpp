// nendo devices: what may be a glove, why, and whether it may be opened. Writes nothing to any of
// them.

#include <iostream>
#include <memory>

#include <nlohmann/json.hpp>

#include <nendo/driver/open_glove.hpp>

#include "cli.hpp"

namespace nendo::app {
namespace {

void print_json(const driver::GloveCandidate& candidate) {
  const nlohmann::ordered_json line{
      {"device", candidate.device},           {"glove", candidate.spec},
      {"description", candidate.description}, {"reason", candidate.reason},
      {"identified", candidate.identified},   {"may_open", candidate.may_open}};
  std::cout << line.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace) << '\n';
}

void print_text(const driver::GloveCandidate& candidate) {
  std::cout << candidate.device << "\n  " << candidate.description << "\n  " << candidate.reason
            << "\n  ";
  if (candidate.spec.empty()) {
    std::cout << "nendo has no driver for it\n";
  } else {
    std::cout << "use it as " << candidate.spec
              << (candidate.may_open ? ""
                                     : ", but you may not open it yet: see who owns the device")
              << '\n';
  }
}

int list_devices(bool json) {
  const auto candidates = driver::find_gloves();
  for (const auto& candidate : candidates)
    json ? print_json(candidate) : print_text(candidate);
  if (candidates.empty() && !json) {
    std::cout << "No serial port or USB device here may be a glove. Plug one in, or try `sim`.\n";
  }
  return 0;
}

} // namespace

void add_devices(CLI::App& app, int& exit_code) {
  auto json = std::make_shared<bool>(false);
  CLI::App& command =
      *app.add_subcommand("devices", "Lists ports and USB devices that may be gloves, and why");
  command.add_flag("--json", *json, "One JSON object a line");
  on_chosen(command, exit_code, [json] { return list_devices(*json); });
}

} // namespace nendo::app
