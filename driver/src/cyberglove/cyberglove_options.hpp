#pragma once
// The options of a CyberGlove's specification, and what follows from them for the shape and rate of
// its records. The functions are pure.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/sample.hpp>

#include "cyberglove/cyberglove_period.hpp"

namespace nendo::driver::cyberglove {

/// The grammar, for the table of drivers.
inline constexpr std::string_view options_grammar =
    "serial:PATH[?baud=N&rate=HZ&mask=0xBITS&stamps=on|off&filter=on|off&quantised=on|off&"
    "sync=on|off&hires=on|off&hand=left|right]";

/// Options that are not given leave the glove as it is.
struct Options {
  std::optional<int> baud; ///< otherwise it is looked for
  std::optional<double> rate_hz;
  std::optional<SensorMask> mask; ///< of the sensors that are built in, those to be sent
  std::optional<bool> stamps;     ///< time stamp and status byte; on where the line carries them
  std::optional<bool> filter;
  std::optional<bool> quantised;
  bool sync = false;        ///< a record at each pulse of the sync input
  bool hires = false;       ///< 12-bit values (CyberGlove III)
  std::optional<Side> hand; ///< whatever the glove says of itself
};

/// Reads the options. Error: usage, naming the option and what it may be.
Result<Options> read_options(const GloveSpec& spec);

struct RecordPlan {
  bool stamps = true;
  bool stamps_dropped = false;  ///< nobody said so, but only without them the line is fast enough
  std::optional<Period> period; ///< to set
  std::size_t record_bytes = 0;
};

/// Decides, before anything is set, how records of `values` values can come at the wanted rate or,
/// if none is wanted, at `present_hz` (0 if unknown). Error: usage, if the line cannot carry the
/// wanted rate; the message begins with the option and shows the calculation.
Result<RecordPlan> plan_records(const Options& options, std::size_t values, int baud,
                                double present_hz);

/// Does the same for records of 12-bit values. Returns the wanted rate as a multiple of 30 Hz, or
/// nothing if no rate is wanted.
Result<std::optional<std::uint8_t>> plan_hires(const Options& options, int baud);

} // namespace nendo::driver::cyberglove
