#pragma once
// The serial protocol of the Polhemus FASTRAK, which InterSense's IS-300, IS-600 and IS-900 speak
// as well. Each fact names who states it:
//   [M n] the FASTRAK manual OPM00PI002 Rev. G (June 2012), page n
//   [I]   the InterSense IS-900 guide
//   [V]   VRPN's drivers, which ran with devices: vrpn_Tracker_Fastrak.C and vrpn_Tracker_Liberty.C
//   [S]   VESS, vsFastrak.h++
//   [?]   stated by no source, chosen here
//
// 8N1 without flow control [M 33]. Commands of one letter act at once. The others end with a CR,
// and their parameters are separated by commas [M 34]. ^K and W change the EEPROM: they are never
// sent.

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace nendo::driver::fastrak {

/// Rates of the line, set by switches at the back [M 33]: laboratories' first, and VRPN's default
/// before the slowest.
inline constexpr std::array bauds{115'200, 38'400, 19'200, 9'600, 57'600};

// The others are in polhemus_greeting.hpp.
/// Which stations are on [M 54].
inline constexpr std::string_view stations_query = "l1\r";
/// A stylus makes no output of its own; its button would end the stream [M 90, V].
inline constexpr std::string_view no_stylus_command = "e1,0\r";

/// FASTRAK has 4 stations; InterSense up to 12, as hexadecimal digits [I].
inline constexpr std::uint16_t fastrak_stations = 4;
inline constexpr std::uint16_t max_stations = 12;

/// Position and quaternion, closed by CR LF [M 57].
inline constexpr std::string_view record_items = ",2,11,1\r";
// The record in binary form [M 47, 57, V]: begin, station, error letter or a blank, x, y, z in
// centimetres, the quaternion w, x, y, z, all as 32-bit floats, low byte first, CR, LF.
inline constexpr std::size_t record_bytes = 33;
inline constexpr char record_begin = '0';

/// One station after the other, so 120 records per second of one to four stations [M].
inline constexpr double records_per_second = 120.0;
/// From the middle of a measurement to the solution's being ready [M E-2].
inline constexpr std::chrono::microseconds solution_delay{3750};

/// The answer to `S` [M 68], text in each mode.
struct Status {
  unsigned flags = 0;
  std::string error; ///< what the self-test found; empty: nothing
  std::string firmware;
  std::string identification;
  bool is_intersense = false; ///< 54 bytes in place of 55 [V]

  bool is_metric() const noexcept { return (flags & 2U) != 0; }
};

/// Finds a status anywhere in what was heard.
std::optional<Status> find_status(std::string_view heard);

/// Finds the answer to stations_query: a digit per station, 1 if it is on [M 54, S].
std::optional<std::string_view> find_stations(std::string_view heard) noexcept;

/// Returns the commands that were refused [M 89], with the codes of the errors; empty if none was.
std::string find_refusals(std::string_view heard);

/// Returns what the error letter of a record means [M 71]. It is the last error that was found, and
/// stays until the test `T` clears it [M 60], so the record may be good.
std::string_view meaning_of_error(char letter) noexcept;

} // namespace nendo::driver::fastrak
