#pragma once
// The udev rules on this machine: which are in force, and changing those in /etc. `root` stands
// for / everywhere, for images and tests.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::udev {

enum class RuleState : std::uint8_t {
  missing,
  current,  ///< what this version of nendo would install
  outdated, ///< made by another version of nendo
  foreign,  ///< not made by nendo: a file or a link of somebody's own, perhaps to switch it off
};

struct RuleFile {
  std::string name;
  std::filesystem::path path; ///< of the one in force; where install would write if missing
  RuleState state = RuleState::missing;
};

/// The files of driver::udev_files(), as udev finds them: the first of /etc, /run, /usr/local/lib
/// and /usr/lib that has one hides the others.
std::vector<RuleFile> rules_in_force(const std::filesystem::path& root);
/// The same for the administrator's folder alone, /etc/udev/rules.d.
std::vector<RuleFile> rules_in_etc(const std::filesystem::path& root);
std::filesystem::path etc_rules(const std::filesystem::path& root);

/// The bindings, as driver::binding_in() reads them; empty if there is no file. Error: bad_input.
Result<std::string> read_bindings(const std::filesystem::path& root);

struct RuleChange {
  std::filesystem::path path;
  std::optional<std::string> contents; ///< nothing: it is removed
};
/// Writes or removes, each file whole or not at all; a written one may be read by everybody.
/// Blocks as the disk does. Error: no_permission (asks for sudo), failed (a link, too).
Result<void> apply(const RuleChange& change);

/// Has the running udev read its rules again and look at USB devices and ports anew. Returns what
/// came of it, one line. Blocks while udevadm runs.
std::string refresh_udev();

} // namespace nendo::udev
