#pragma once
// The udev rules on this machine: which are in effect, and how to change those in /etc. `root` is
// the folder that stands for /, so that images and tests can be treated alike.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::udev {

enum class RuleState : std::uint8_t {
  missing,
  current,  ///< what this version of nendo would install
  outdated, ///< made by another version of nendo
  foreign,  ///< not made by nendo: another file or link, perhaps to switch it off
};

struct RuleFile {
  std::string name;
  std::filesystem::path path; ///< the file in effect; the target of install if it is missing
  RuleState state = RuleState::missing;
};

/// Returns the files of shipped_rules() as udev finds them: the first of /etc, /run, /usr/local/lib
/// and /usr/lib that has a file of that name hides the others.
NENDO_API std::vector<RuleFile> rules_in_force(const std::filesystem::path& root);
/// Returns the same for the administrator's folder alone, /etc/udev/rules.d.
NENDO_API std::vector<RuleFile> rules_in_etc(const std::filesystem::path& root);
/// Returns the administrator's folder.
NENDO_API std::filesystem::path etc_rules(const std::filesystem::path& root);

/// Returns the file of bindings, which binding_in() reads; an empty text if there is none. Error:
/// bad_input.
NENDO_API Result<std::string> read_bindings(const std::filesystem::path& root);

struct RuleChange {
  std::filesystem::path path;
  std::optional<std::string> contents; ///< nullopt: the file is removed
};
/// Writes or removes a file, whole or not at all. Everybody may read a written one. Blocks as the
/// disk does. Errors: no_permission (the message asks for sudo), failed (also if it is a link).
NENDO_API Result<void> apply(const RuleChange& change);

/// Makes the running udev read its rules again and apply them to USB devices, ports and
/// SpaceMice that are plugged in. Returns one line that says what came of it. Blocks while udevadm
/// runs.
NENDO_API std::string refresh_udev();

} // namespace nendo::udev
