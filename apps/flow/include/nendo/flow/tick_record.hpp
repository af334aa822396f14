#pragma once
// The record of a tick's times, one cache line that goes through a ring. It has lateness, work and
// the age of the input of every single tick.

#include <algorithm>
#include <cstdint>
#include <limits>

#include <nendo/base/spsc_ring.hpp>
#include <nendo/base/units.hpp>

namespace nendo::flow {

struct alignas(cache_line_bytes) TickRecord {
  std::uint64_t tick = 0; ///< Pacer::Due::number
  HostTime scheduled{};   ///< the deadline; paced by samples, when the newest of them arrived
  HostTime woke{};
  /// When the sample arrived that the tick shows. That is the newest sample of a hand, and the
  /// older one of two hands'. It is HostTime{} if none came.
  HostTime input{};
  // The ends of the tick's stages, counted from its wake-up; at most 4.29 s.
  std::uint32_t drained_ns = 0;   ///< the rings are empty, the angles known
  std::uint32_t posed_ns = 0;     ///< the hands' joints and fingertips
  std::uint32_t solved_ns = 0;    ///< the field and the vertices
  std::uint32_t published_ns = 0; ///< the frame is out
  std::uint32_t missed = 0;       ///< deadlines between the tick before and this one
  std::uint32_t samples = 0;      ///< taken from the rings
  std::uint32_t spun_ns = 0;      ///< the time spun before the deadline

  HostTime published() const noexcept { return woke + std::chrono::nanoseconds(published_ns); }
};
static_assert(sizeof(TickRecord) == cache_line_bytes);

/// A full ring refuses records and counts them, so that the loop never waits.
using TickRing = SpscRing<TickRecord>;

constexpr std::uint32_t saturated_ns(HostClock::duration time) noexcept {
  using Nanoseconds = std::chrono::nanoseconds;
  return static_cast<std::uint32_t>(
      std::clamp<Nanoseconds::rep>(std::chrono::duration_cast<Nanoseconds>(time).count(), 0,
                                   std::numeric_limits<std::uint32_t>::max()));
}

} // namespace nendo::flow
