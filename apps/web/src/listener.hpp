#pragma once
// A socket that listens.

#include <cstddef>
#include <optional>

#include <nendo/base/descriptor.hpp>
#include <nendo/base/result.hpp>
#include <nendo/web/endpoint.hpp>

namespace nendo::web {

/// Its port is written to `endpoint`, if that was 0. Error: failed.
Result<Descriptor> listen_at(Endpoint& endpoint);
/// The next connection, non-blocking, for which the system keeps about so many bytes; nothing if
/// there is none.
std::optional<Descriptor> accept_from(const Descriptor& listener, std::size_t buffer_bytes);

} // namespace nendo::web
