#pragma once
// The counts of an SpscRing. Each count only grows and is written by one thread; other threads may
// read it at any time. The sum below holds once both sides are at rest.

#include <cstdint>

namespace nendo {

/// offered = consumed + refused + SpscRing::size()
struct RingCounters {
  std::uint64_t offered = 0;  ///< elements pushed, or tried to
  std::uint64_t refused = 0;  ///< the offered elements that were refused because the ring was full
  std::uint64_t consumed = 0; ///< elements taken out
  std::uint64_t high_water = 0; ///< the most that were ever in it at once
};

} // namespace nendo
