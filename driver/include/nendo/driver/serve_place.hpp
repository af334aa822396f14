#pragma once
// The places of the socket by which `nendo serve` shares devices: one for each user, and one for
// services.

#include <string>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo::driver {

/// The name of a server and of its socket, if none is given.
inline constexpr std::string_view default_serve_name = "hands";

struct ServeFolders {
  std::string own;                    ///< this user's; empty: none
  std::string services{"/run/nendo"}; ///< writable for the service that has it
};

/// Returns $XDG_RUNTIME_DIR/nendo, which need not exist, and the folder of services. Reads the
/// environment, which no other thread may change meanwhile.
NENDO_API ServeFolders serve_folders();

/// Returns FOLDER/NAME.sock.
NENDO_API std::string serve_socket(const std::string& folder, std::string_view name);

} // namespace nendo::driver
