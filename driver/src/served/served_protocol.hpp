#pragma once
// The protocol of `nendo serve`, which apps/serve/PROTOCOL.md describes: lines of JSON at a
// Unix-domain socket. The limits are chosen.

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nendo::driver::served {

inline constexpr std::int64_t protocol_number = 1;
inline constexpr std::size_t max_line_bytes = 65'536; ///< with LF
inline constexpr int max_depth = 16;                  ///< nested objects and arrays; HANDS has 6
/// Values, keys, begins and ends of objects and arrays in a line; HANDS has 1100.
inline constexpr std::size_t max_values = 4096;
inline constexpr std::size_t max_devices = 32;  ///< gloves, or trackers, of a server
inline constexpr std::uint32_t max_index = 255; ///< a device's number

/// The largest distance of a time from zero: no difference of two times overflows.
inline constexpr std::chrono::nanoseconds max_time{std::int64_t{1} << 61};
/// The largest age of a sample: where it is larger, the server has another clock.
inline constexpr std::chrono::hours max_age{1};

inline constexpr std::byte line_end{'\n'};
inline constexpr std::string_view watch_nothing = "{\"class\":\"WATCH\",\"samples\":false}\n";
inline constexpr std::string_view watch_samples = "{\"class\":\"WATCH\",\"samples\":true}\n";

} // namespace nendo::driver::served
