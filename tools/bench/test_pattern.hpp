#pragma once
// Checks whether a sample holds what the emulated glove sent. In record n its motion `pattern`
// sends, for the sensor of slot k, the count 1 + (n + 29 k) mod 255 (16 times as much with 12
// bits). So every sample can be checked by itself: a value in its neighbour's place, or of another
// record, does not fit the others.

#include <nendo/driver/sample.hpp>

namespace nendo::bench {

enum class PatternVerdict {
  whole, ///< every value is that of one and the same record
  /// All values but one or two fit, and those are off by a single bit each, which no check of the
  /// structure can find.
  flipped,
  broken, ///< made of parts that do not belong together: should never have been delivered
};

PatternVerdict judge_pattern(const GloveSample& sample, unsigned steps_a_count) noexcept;

} // namespace nendo::bench
