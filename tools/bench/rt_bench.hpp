#pragma once
// The parts of nendo bench rt. Each measures one thing that real time depends on, beside a baseline
// in the same run, and prints it.

#include <cstdint>

#include <nendo/base/result.hpp>

namespace nendo::bench {

struct RtOptions {
  std::uint64_t rounds = 20;  ///< rounds of each contender, in an order that rotates
  std::uint32_t seconds = 10; ///< duration of each measurement of the loop, 1 to 3600
  bool json = false;          ///< one object per line in place of text
};

/// Measures SpscRing, one element at a time and in batches, beside other rings. Takes some 0.2 s a
/// round.
Result<void> measure_rings(const RtOptions& options);
/// Measures what publishing a frame costs its writer, by TripleBuffer and by a mutex with a
/// condition variable. Takes some 0.6 s a round.
Result<void> measure_handoff(const RtOptions& options);

/// Measures the loop beside cyclictest in the same seconds, its spin tail, and all of a tick's
/// work, and compares each with its goal. Takes six times `seconds`. Errors: no_permission if
/// real-time rights are refused. It also fails without cyclictest (package rt-tests), and if a
/// signal stops it.
Result<void> measure_loop(const RtOptions& options);

} // namespace nendo::bench
