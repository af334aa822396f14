#pragma once
// Judges whether a sample holds what the emulated glove sent. Its motion `pattern` sends, in record
// n, for the sensor of slot k the count 1 + (n + 29 k) mod 255 (16 times as much with 12 bits), so
// that every sample can be judged by itself: a value that slipped into the neighbour's place, or
// came from another record, does not fit the others.

#include <nendo/driver/sample.hpp>

namespace nendo::bench {

enum class PatternVerdict {
  whole, ///< every value is that of one and the same record
  /// All but one or two, and those are off by a single bit each: no structure can expose it.
  flipped,
  broken, ///< made of parts that do not belong together: should never have been delivered
};

PatternVerdict judge_pattern(const GloveSample& sample, unsigned steps_a_count) noexcept;

} // namespace nendo::bench
