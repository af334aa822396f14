#pragma once
// The verdict of a stress test in one line: whether the loop kept its rate on this machine, or why
// it did not, and what would help.

#include <cstdint>
#include <string>

#include "stress/stress_session.hpp"

namespace nendo::stress {

struct Verdict {
  /// The loop is on a grid, so that a tick can be late. A loop that samples pace has no rate to
  /// keep.
  bool judged = true;
  bool punctual = false;  ///< every tick that was due began before the next one was
  std::uint64_t due = 0;  ///< ticks that were
  std::uint64_t late = 0; ///< of these: they began after the next one was due, or not at all
  double max_late_us = 0.0;
  std::string reason; ///< why some were late; empty if none was
  std::string remedy; ///< what to try; empty if none was
};

/// Judges a test. Pure.
Verdict judge(const StressOptions& options, const StressOutcome& outcome);

/// Returns the verdict as one line for people: "1 kHz: yes, with ..." or "1 kHz: no: 38 of 5,000
/// ticks were late, by up to ..., because ...; try ...".
std::string in_words(const Verdict& verdict, const StressOptions& options,
                     const StressOutcome& outcome);

} // namespace nendo::stress
