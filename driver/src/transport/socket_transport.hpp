#pragma once
// A connection of a stream socket as a Transport.

#include <memory>

#include <nendo/base/unique_fd.hpp>

#include "transport/transport.hpp"

namespace nendo::driver {

/// Takes over a stream socket, which must be connected and non-blocking. The transport discards no
/// input that has arrived (Transport::discard_input does nothing), because the rest of the
/// conversation has no meaning without its beginning.
std::unique_ptr<Transport> transport_of_socket(UniqueFd socket);

} // namespace nendo::driver
