#pragma once
// What the user may ask of a CyberGlove in its specification, and what follows from it for the
// shape and rate of its records. Pure.

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/sample.hpp>

#include "cyberglove/cyberglove_period.hpp"

namespace nendo::driver::cyberglove {

/// For the driver table.
inline constexpr std::string_view options_grammar =
    "serial:PATH[?baud=N&rate=HZ&mask=0xBITS&stamps=on|off&filter=on|off&quantised=on|off&"
    "sync=on|off&hires=on|off]";

/// Options that are not given leave the glove as it is.
struct Options {
  std::optional<int> baud; ///< otherwise it is looked for
  std::optional<double> rate_hz;
  std::optional<SensorMask> mask; ///< of the sensors that are built in, those to be sent
  std::optional<bool> stamps;     ///< time stamp and status byte; on where the line carries them
  std::optional<bool> filter;
  std::optional<bool> quantised;
  bool sync = false;  ///< a record at each pulse of the sync input
  bool hires = false; ///< 12-bit values (CyberGlove III)
};

/// Error: usage, naming the option and what it may be.
Result<Options> read_options(const GloveSpec& spec);

struct RecordPlan {
  bool stamps = true;
  bool stamps_dropped = false;  ///< nobody said so, but only without them the line is fast enough
  std::optional<Period> period; ///< to set
  std::size_t record_bytes = 0;
};

/// Decides, before anything is set, how records of `values` values can come at the wanted rate, or
/// else at `present_hz` (0: unknown). Error: usage, if the line cannot carry the wanted rate; the
/// message has the arithmetic and begins with the option.
Result<RecordPlan> plan_records(const Options& options, std::size_t values, int baud,
                                double present_hz);

/// The same for the records of 12-bit values, whose rate is a multiple of 30 Hz: how many times.
/// Nothing if no rate is wanted.
Result<std::optional<std::uint8_t>> plan_hires(const Options& options, int baud);

} // namespace nendo::driver::cyberglove
