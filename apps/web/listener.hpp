#pragma once
// The socket that listens for connections.

#include <cstddef>
#include <optional>

#include <nendo/base/result.hpp>
#include <nendo/base/unique_fd.hpp>

#include "web/endpoint.hpp"

namespace nendo::web {

/// Opens a non-blocking socket that listens at `endpoint`, and writes the port to `endpoint`.
/// Error: failed.
Result<UniqueFd> listen_at(Endpoint& endpoint);
/// Returns the next connection as a non-blocking socket, or nothing if there is none. buffer_bytes:
/// the size of the socket's send buffer.
std::optional<UniqueFd> accept_from(const UniqueFd& listener, std::size_t buffer_bytes);

} // namespace nendo::web
