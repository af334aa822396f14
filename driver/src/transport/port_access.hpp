#pragma once
// Who may open a device node, and what this user must do to be among them.

#include <string>

namespace nendo::driver {

struct PortAccess {
  bool granted = false; ///< this user may read and write it
  std::string who;      ///< "you", "group dialout", "user anna", "root"
  std::string remedy;   ///< empty if granted
};

/// Asks the file system; does not open it. A node that is gone is nobody's: `who` is empty.
PortAccess port_access(const std::string& path);
/// Returns the same for a device that refused to be opened, whatever the file system says.
PortAccess refused_access(const std::string& path);

} // namespace nendo::driver
