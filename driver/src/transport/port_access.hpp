#pragma once
// Tells who may open a device node, and what this user must do to be allowed to.

#include <string>

namespace nendo::driver {

struct PortAccess {
  bool granted = false;      ///< this user may read and write it
  std::string who;           ///< "you", "group dialout", "user anna", "root"
  std::string remedy;        ///< empty if granted
  bool node_missing = false; ///< the kernel has the device, and /dev has no node for it
};

/// Asks the file system and does not open the node. `who` is empty if there is no node.
PortAccess port_access(const std::string& path);
/// Returns the same for a device that refused to be opened, whatever the file system says.
PortAccess refused_access(const std::string& path);

} // namespace nendo::driver
