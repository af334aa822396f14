#pragma once
// The requests of clients, which may be anything. Pure, but it allocates.

#include <cstddef>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::serve {

/// What a client watches.
struct Watch {
  bool samples = false; ///< samples and poses
  bool hands = false;
  double rate_hz = 30.0; ///< max frames of hands per second
  friend bool operator==(const Watch&, const Watch&) = default;
};

inline constexpr double min_rate_hz = 0.1;
inline constexpr double max_rate_hz = 1000.0;
inline constexpr std::size_t max_request_bytes = 4096; ///< with LF

/// Returns what the client watches after a request, a line without its end. Error: bad_input, in a
/// message without text of the client.
Result<Watch> changed(const Watch& watch, std::string_view request);

} // namespace nendo::serve
