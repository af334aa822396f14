#pragma once
// The serial protocol of the Polhemus ISOTRAK II. Each fact names who states it:
//   [V] VRPN's vrpn_Tracker_Isotrak.C, which ran with it
//   [O] OpenTracker's FastTrakModule.cxx, which ran with it
//   [J] github.com/cybergarage/polhemuse-java, Isotrak2.java
//   [?] stated by no source, chosen here
//
// Its commands are FASTRAK's (polhemus_greeting.hpp), but for those below [V, O]. `e` and `I` are
// not sent: no source that ran with it has them, and public lists of its commands give them other
// parameters or meanings than FASTRAK's. ^K and W, which change a FASTRAK's EEPROM, are never sent.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nendo::driver::isotrak {

/// Rates of the line: [O]'s, VRPN's default, and others [?].
inline constexpr std::array bauds{115'200, 19'200, 9'600, 38'400, 57'600};
inline constexpr std::uint16_t max_stations = 2; ///< [V]

/// The answer to `S` begins with `2`, and VRPN reads 21 bytes [V]. That its third byte is an S and
/// its last ones are CR LF, as FASTRAK's, and that it may be longer, but less than that, is [?].
inline constexpr std::size_t min_status_bytes = 21;
inline constexpr std::size_t max_status_bytes = 53;

inline constexpr std::string_view poll_command = "P"; ///< one record per station [O, J]
/// Position and quaternion, of all stations [V, O].
inline constexpr std::string_view record_items = "O2,11\r";

// The record in binary form [V]: `0`, the digit of the station, the button (`*` or `@`) or a blank
// [O], x, y, z, the quaternion w, x, y, z, each a signed word, low byte first. It is sent in groups
// of up to seven bytes. Each is followed by a byte with their bits 7, the first byte's as bit 0,
// and its own bytes have none, but for the record's first byte, where bit 7 is set. That a letter
// can be in place of the button, as an error of FASTRAK, is [?].
inline constexpr std::size_t record_bytes = 20;
inline constexpr std::size_t group_bytes = 7;
inline constexpr std::size_t unpacked_bytes = 17;
inline constexpr double full_scale = 32767.0;      ///< 1 in a quaternion [V]
inline constexpr double position_range_m = 1.6632; ///< a position of full_scale, after `u` [V]

/// One station after the other, so 60 records per second of one or two stations [?].
inline constexpr double records_per_second = 60.0;

} // namespace nendo::driver::isotrak
