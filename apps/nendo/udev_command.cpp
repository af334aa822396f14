// nendo udev: installs the rules that make gloves and SpaceMice usable without root, and binds
// gloves and trackers to adapters.

#include <filesystem>
#include <iostream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <nendo/base/advised_command.hpp>
#include <nendo/driver/devices.hpp>
#include <nendo/udev/bindings.hpp>
#include <nendo/udev/installed_rules.hpp>
#include <nendo/udev/rules.hpp>

#include "cli/cli.hpp"
#include "nendo/commands.hpp"

namespace nendo::app::udev_command {
namespace {

struct Options {
  std::string root = "/";
  bool dry_run = false;
  std::string file;   ///< show
  std::string port;   ///< bind
  std::string device; ///< bind, unbind: name_of(udev::BoundDevice)
  bool by_place = false;
};

udev::BoundDevice device_of(const Options& options) {
  for (const udev::BoundDevice device : udev::bound_devices)
    if (options.device == name_of(device)) return device;
  return {}; // the command line admits no other name
}

/// Makes the changes and reports each. Returns the exit code.
int carry_out(const std::vector<udev::RuleChange>& changes, const Options& options) {
  for (const udev::RuleChange& change : changes) {
    const std::string path = change.path.string();
    if (options.dry_run) {
      std::cout << (change.contents ? "would write " : "would remove ") << path << '\n';
      continue;
    }
    if (const auto done = udev::apply(change); !done) return cli::report(done.error());
    std::cout << (change.contents ? "wrote " : "removed ") << path << '\n';
  }
  if (!changes.empty() && !options.dry_run && std::filesystem::path(options.root) == "/")
    std::cout << udev::refresh_udev() << '\n';
  return 0;
}

Error foreign(const udev::RuleFile& file) {
  return {Errc::failed, file.path.string() + ": not made by nendo, so it is not changed; move it "
                                             "away to install nendo's"};
}

int install(const Options& options) {
  std::vector<udev::RuleChange> changes;
  const auto rules = udev::shipped_rules();
  const auto current = udev::rules_in_force(options.root);
  for (std::size_t k = 0; k < rules.size(); ++k) {
    const udev::RuleFile& file = current[k];
    if (file.state == udev::RuleState::foreign) return cli::report(foreign(file));
    if (file.state == udev::RuleState::current) {
      std::cout << "unchanged " << file.path.string() << '\n';
    } else {
      changes.push_back({udev::etc_rules(options.root) / file.name, rules[k].text});
    }
  }
  return carry_out(changes, options);
}

/// Bindings stay, because they belong to the user, and are harmless without the rules.
int uninstall(const Options& options) {
  std::vector<udev::RuleChange> changes;
  for (const udev::RuleFile& file : udev::rules_in_etc(options.root)) {
    if (file.state == udev::RuleState::foreign) {
      cli::note(foreign(file).message);
    } else if (file.state == udev::RuleState::missing) {
      std::cout << "missing " << file.path.string() << '\n';
    } else {
      changes.push_back({file.path, std::nullopt});
    }
  }
  const int code = carry_out(changes, options);
  for (const udev::RuleFile& file : udev::rules_in_force(options.root)) {
    if (file.state != udev::RuleState::missing &&
        !file.path.string().starts_with(udev::etc_rules(options.root).string()))
      std::cout << "kept " << file.path.string() << ", which belongs to a package\n";
  }
  return code;
}

int show(const Options& options) {
  for (const udev::RuleText& file : udev::shipped_rules()) {
    if (file.name != options.file) continue;
    std::cout << file.text;
    return 0;
  }
  if (!options.file.empty()) {
    return cli::report({Errc::usage, options.file +
                                         ": no such file of rules; the files are 60-nendo.rules "
                                         "and 61-nendo-uaccess.rules"});
  }
  for (const udev::RuleFile& file : udev::rules_in_force(options.root)) {
    const std::string words[]{"not installed; " + as_root("udev install"), "current",
                              "of another version; " + as_root("udev install"), "not nendo's"};
    std::cout << file.path.string() << ": " << words[static_cast<std::size_t>(file.state)] << '\n';
  }
  const auto bindings = udev::read_bindings(options.root);
  if (!bindings) return cli::report(bindings.error());
  for (const udev::BoundDevice device : udev::bound_devices) {
    std::cout << name_of(device) << ": "
              << udev::binding_in(*bindings, device).value_or("not bound") << '\n';
  }
  return 0;
}

int change_bindings(const std::string& before, const std::string& after, const Options& options) {
  const auto path = udev::etc_rules(options.root) / udev::binding_file_name;
  std::vector<udev::RuleChange> changes;
  if (after == before) {
    std::cout << "unchanged " << path.string() << '\n';
  } else {
    changes.push_back({path, after.empty() ? std::nullopt : std::optional(after)});
  }
  return carry_out(changes, options);
}

int bind(const Options& options) {
  std::vector<udev::SerialPort> ports;
  for (driver::DeviceCandidate& candidate : driver::find_devices()) {
    if (candidate.kind == driver::DeviceKind::serial_port)
      ports.push_back({std::move(candidate.device), std::move(candidate.usb)});
  }
  const auto binding = udev::make_binding(driver::resolve_port(options.port), ports,
                                          device_of(options), options.by_place);
  if (!binding) return cli::report(binding.error());
  const auto rule = udev::rule_of(*binding);
  if (!rule) return cli::report(rule.error());
  const auto bindings = udev::read_bindings(options.root);
  if (!bindings) return cli::report(bindings.error());
  std::cout << *rule << std::endl;
  if (!options.by_place && binding->adapter.serial == "0001") // the CP2102's default
    cli::note("many adapters have the serial number 0001; --by-place distinguishes them");
  const int code =
      change_bindings(*bindings, udev::with_binding(*bindings, device_of(options), *rule), options);
  for (const udev::RuleFile& file : udev::rules_in_force(options.root)) {
    if (code == 0 && file.state == udev::RuleState::missing)
      cli::note(file.name +
                " is not installed, and the binding needs it: " + as_root("udev install"));
  }
  return code;
}

int unbind(const Options& options) {
  const auto bindings = udev::read_bindings(options.root);
  if (!bindings) return cli::report(bindings.error());
  return change_bindings(*bindings, udev::without_binding(*bindings, device_of(options)), options);
}

using Action = int (*)(const Options& options);

cli::Command add(cli::Command& udev, const std::shared_ptr<Options>& options,
                 const std::string& name, const std::string& summary, Action action) {
  cli::Command command = udev.add_command(name, summary);
  command.add_option("--root", options->root, "Folder to use in place of /, e.g. of an image");
  if (action != show)
    command.add_flag("--dry-run", options->dry_run, "Print the changes without making them");
  command.on_chosen([options, action] { return action(*options); });
  return command;
}

} // namespace
} // namespace nendo::app::udev_command

void nendo::app::add_udev(cli::Command& program) {
  using namespace udev_command;
  auto options = std::make_shared<Options>();
  cli::Command udev = program.add_command(
      "udev", "Makes gloves and trackers usable without root, and gives them stable names");
  udev.require_command();
  udev.set_footer("Rules go to /etc/udev/rules.d, for which changes need sudo.");
  add(udev, options, "install",
      "Installs the rules that identify gloves and SpaceMice, and grant access to them", install);
  add(udev, options, "uninstall", "Removes the installed rules; bindings stay", uninstall);
  cli::Command shown = add(udev, options, "show", "Shows the rules and bindings in effect", show);
  shown.add_option("FILE", options->file, "Print this file of rules, as install writes it");
  cli::Command bound =
      add(udev, options, "bind",
          "Binds an adapter, known by its serial number, to a glove or a tracker", bind);
  bound.add_option("PORT", options->port, "The device's port, e.g. /dev/ttyUSB0").required();
  bound
      .add_option(
          "--as", options->device,
          "The hand that wears the glove, or tracker, whose port is then /dev/nendo/tracker")
      .required()
      .one_of({"left", "right", "tracker"});
  bound.add_flag("--by-place", options->by_place,
                 "Identify it by its USB socket, for adapters without a serial number");
  cli::Command unbound = add(udev, options, "unbind", "Removes a device's binding", unbind);
  unbound.add_option("DEVICE", options->device, "left, right or tracker")
      .required()
      .one_of({"left", "right", "tracker"});
}
