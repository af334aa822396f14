#pragma once
// Runs every fault that a line, an interface unit or a person can cause against every model of
// CyberGlove, through the real driver over a pseudo-terminal. Measures its cost, how soon it was
// over, and whether anything wrong was delivered.

#include <atomic>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/driver/glove.hpp>

namespace nendo::bench {

/// A fault, and what it may cost at most.
struct FaultCase {
  std::string_view name;
  std::string_view happens;        ///< in a person's words
  std::vector<std::string> faults; ///< as the emulator takes them
  double longest_gap_s = 0.5;      ///< between two samples, the fault's own time included
  bool flips = false;              ///< single wrong bits in sensor bytes are to be expected
  bool counts_all = true; ///< sent = delivered + missed must hold: the stream never began again
  bool swaps_hand = false;
  bool swaps_sensors = false;
};
const std::vector<FaultCase>& fault_cases();

struct GloveCase {
  std::string_view name;
  unsigned model;
  unsigned sensors;
  std::string_view options; ///< options of the GLOVE specification
};
const std::vector<GloveCase>& glove_cases();

struct FaultOutcome {
  const FaultCase* fault = nullptr;
  const GloveCase* glove = nullptr;
  std::uint64_t sent = 0;    ///< whole records, by the emulator's count
  std::uint64_t faulted = 0; ///< number of these that the fault changed
  std::uint64_t delivered = 0;
  std::uint64_t flipped = 0; ///< delivered with one wrong bit in one sensor
  std::uint64_t broken = 0;  ///< delivered though their structure was wrong: must be 0
  driver::StreamStats stats{};
  double longest_gap_s = 0.0; ///< between two samples
  std::string complaint{};    ///< empty: as it should be
};

/// Runs all pairs, `at_once` of them at a time, each for `seconds` (at least 4). Blocks. Fails if
/// an emulator or a glove cannot be opened.
Result<std::vector<FaultOutcome>> run_fault_matrix(double seconds, unsigned at_once,
                                                   const std::atomic<bool>& stop);

} // namespace nendo::bench
