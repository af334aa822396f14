#pragma once
// The options of a CyberGlove's specification, the capacity of its serial line, and the period and
// shape of records that follow from both. The functions are pure.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>

#include <nendo/base/result.hpp>
#include <nendo/driver/open_glove.hpp>
#include <nendo/driver/sample.hpp>

namespace nendo::driver::cyberglove {

/// The grammar, for the table of drivers.
inline constexpr std::string_view options_grammar =
    "serial:PATH[?baud=N&rate=HZ&mask=0xBITS&stamps=on|off&filter=on|off&quantised=on|off&"
    "sync=on|off&hires=on|off&hand=left|right]";

/// Options that are not given leave the glove as it is.
struct Options {
  std::optional<int> baud; ///< otherwise it is searched for
  std::optional<double> rate_hz;
  std::optional<SensorMask> mask; ///< the built-in sensors to send
  std::optional<bool> stamps;     ///< time stamp and status byte; on where the line carries them
  std::optional<bool> filter;
  std::optional<bool> quantised;
  bool sync = false;        ///< a record at each pulse of the sync input
  bool hires = false;       ///< 12-bit values (CyberGlove III)
  std::optional<Side> hand; ///< overrides the glove's own
};

/// Reads the options. Error: usage, naming the option and what it may be.
Result<Options> read_options(const DeviceSpec& spec);

/// The rates to try, likeliest first. Every driver since about 2000 uses
/// 115200; the others are defaults of older units.
inline constexpr std::array usual_bauds{115'200, 38'400, 19'200, 9'600};

/// A byte has a start bit, eight data bits and a stop bit.
inline constexpr double bits_per_byte = 10.0;

/// Returns the max number of records per second on a line.
constexpr double line_limit_hz(int baud, std::size_t record_bytes) noexcept {
  return baud / (bits_per_byte * static_cast<double>(record_bytes));
}

/// Returns the line rate of a byte of 'B', rounded; nothing for a byte with other bits. The byte is
/// the BAUD register of the unit's processor, a Motorola 68HC11: bits 5:4 choose a prescaler, bits
/// 2:0 a power of two. (The vendor's library masks the byte with 0x37, which is just these bits;
/// one driver takes the prescaler from bits 4:3, which fits no such chip.)
constexpr std::optional<int> baud_of_register(std::uint8_t byte) noexcept {
  constexpr int baud_base = 115'200;
  constexpr unsigned baud_bits = 0x37;
  constexpr std::array prescalers{1, 3, 4, 13};
  if ((byte & ~baud_bits) != 0) return std::nullopt;
  const int divisor = prescalers[byte >> 4U & 3U] << (byte & 7U);
  return (baud_base + divisor / 2) / divisor;
}

/// The time between two records of a stream, as the unit counts it: `times` times `ticks` of
/// 1/115200 s [p.47].
struct Period {
  std::uint16_t ticks = 0;
  std::uint16_t times = 0;
  friend bool operator==(Period, Period) = default;
};

/// Returns the records per second, or 0 if either word is 0, which means as fast as the glove can.
double rate_of(Period period) noexcept;

/// Returns the period nearest to 1/rate_hz: exact to half a tick above 1.76 Hz, and to `times` / 2
/// ticks below. Returns nullopt above 115200 Hz, below one record in ten hours, and for NaN.
std::optional<Period> choose_period(double rate_hz) noexcept;

/// Which byte of a word comes first in the reply to ?T. Sources contradict each other: the authors
/// who had the manual, and the unit's processor, say high; the vendor's library writes other words
/// low first.
enum class WordOrder : std::uint8_t { high_first, low_first };

using PeriodBytes = std::span<const std::byte, 4>;

Period decode_period(PeriodBytes bytes, WordOrder order) noexcept;

/// Returns the byte order in which `bytes` mean `period`; nothing if they mean another one.
std::optional<WordOrder> order_of(PeriodBytes bytes, Period period) noexcept;

/// Returns the likely period of a unit whose byte order is unknown. The wrong order mostly yields a
/// very slow rate, so the faster rate up to 1000 Hz is taken and, of two equal rates, the period
/// with the smaller `times`. Returns nothing if both are faster.
std::optional<Period> guess_period(PeriodBytes bytes) noexcept;

struct RecordPlan {
  bool stamps = true;
  bool stamps_dropped = false; ///< no option says so, but only without them the line is fast enough
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
