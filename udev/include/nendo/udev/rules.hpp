#pragma once
// The text of the udev rules, made from the table of devices. The same text is committed in udev/,
// for packagers; a test proves that the two are the same.

#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/api.hpp>

namespace nendo::udev {

/// A file of rules.
struct RuleText {
  std::string_view name; ///< in a folder like /etc/udev/rules.d
  std::string text;
};

/// Returns 60-nendo.rules, which says which devices are gloves or SpaceMice, and
/// 61-nendo-uaccess.rules, which grants them to the user at the screen, and gloves also to a group.
/// Neither names USB-serial adapters, because anything may be connected to them.
NENDO_API std::vector<RuleText> shipped_rules();

/// The first line of these files begins with this mark; files without it are not nendo's.
inline constexpr std::string_view rule_mark = "# Made by nendo: ";

} // namespace nendo::udev
