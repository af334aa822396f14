#pragma once
// What the rings count. Every count only grows and has one thread that writes it; other threads may
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

/// pushed = got + lost, when OverwritingRing is drained
struct OverwritingRingCounters {
  std::uint64_t pushed = 0;
  std::uint64_t got = 0;  ///< elements taken out
  std::uint64_t lost = 0; ///< elements overwritten before the consumer had them
};

/// offered = taken + dropped + frames published and not yet taken
struct FramePoolCounters {
  std::uint64_t offered = 0;    ///< frames published, and frames dropped
  std::uint64_t dropped = 0;    ///< times that the writer found no empty frame
  std::uint64_t taken = 0;      ///< frames that the reader took
  std::uint64_t high_water = 0; ///< the most that ever waited for the reader at once
};

} // namespace nendo
