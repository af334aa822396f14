#pragma once
// Times of HostClock in UTC.

#include <cstdint>

#include <nendo/base/api.hpp>
#include <nendo/base/units.hpp>

namespace nendo {

/// Returns the nanoseconds from 1970 to `time` in UTC, by both clocks as they are now: the system's
/// may be set at any time. Precise even if the thread now and then loses its processor between
/// readings of the clocks. Wait-free.
NENDO_API std::int64_t utc_ns(HostTime time) noexcept;

} // namespace nendo
