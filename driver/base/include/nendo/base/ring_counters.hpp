#pragma once
// What SpscRing counts. Every count only grows and has one thread that writes it; other threads may
// read it at any time, and the sums hold once both sides are at rest.

#include <cstdint>

namespace nendo {

/// offered = consumed + refused + SpscRing::size()
struct RingCounters {
  std::uint64_t offered = 0;    ///< elements pushed, or tried to
  std::uint64_t refused = 0;    ///< of those, refused because the ring was full
  std::uint64_t consumed = 0;   ///< elements taken out
  std::uint64_t high_water = 0; ///< the most that were ever in it at once
};

} // namespace nendo
