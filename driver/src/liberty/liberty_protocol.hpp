#pragma once
// The serial protocol of the Polhemus LIBERTY, PATRIOT and Latus. Each fact names who states it:
//   [V] VRPN's vrpn_Tracker_Liberty.C, which ran with LIBERTY and PATRIOT
//   [R] github.com/shadow-robot/polhemus_ros_driver, which ran with LIBERTY by USB
//   [?] stated by no source, chosen here
//
// All commands but `P` end with a CR [V]. The answer to a command and each record begin with the
// same header, in binary form [R]: two letters of the model, the station from 1 on, the command's
// letter, an error letter or a blank [V], a reserved byte, the number of bytes that follow, low
// byte first.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nendo::driver::liberty {

inline constexpr std::array bauds{115'200, 57'600, 38'400, 19'200, 9'600}; ///< the order is [?]
inline constexpr std::uint16_t max_stations = 16;

inline constexpr std::string_view poll_command = "P"; ///< one record each; ends the stream [V]
inline constexpr std::string_view stream_command = "C\r";
inline constexpr std::string_view text_command = "F0\r";
inline constexpr std::string_view binary_command = "F1\r";
inline constexpr std::string_view centimetres_command = "U1\r"; ///< inches otherwise [V]
inline constexpr std::string_view zero_clock_command = "Q0\r";  ///< [V]
inline constexpr std::string_view who_query = "\x16\r"; ///< ^V: 196 to 247 bytes of text [V]
inline constexpr std::size_t min_who_bytes = 150;       ///< [?]
inline constexpr std::size_t max_who_bytes = 512;       ///< [?]
/// ^U: two 16-bit maps, of the stations that are detected and those that are active [R].
inline constexpr std::string_view stations_query = "\x15\x30\r";
inline constexpr std::uint8_t stations_answer = 0x15;
// Filters of position and attitude, off and VRPN's middle way [V].
inline constexpr std::array<std::string_view, 2> filters_off{"X0,1,0,0\r", "Y0,1,0,0\r"};
inline constexpr std::array<std::string_view, 2> filters_on{"X0.2,0.2,0.8,0.8\r",
                                                            "Y0.2,0.2,0.8,0.8\r"};

inline constexpr std::size_t header_bytes = 8;
// A record of `O*,8,9,11,3,7,1` [R]: header, time in ms, number of the frame, distortion, all with
// 32 bits, x, y, z, the quaternion w, x, y, z as 32-bit floats, CR, LF. One without distortion is 4
// bytes shorter, for the line's sake.
inline constexpr std::string_view full_records = "O*,8,9,11,3,7,1\r";
inline constexpr std::string_view short_records = "O*,8,9,3,7,1\r";
inline constexpr std::size_t full_bytes = 50;
inline constexpr std::size_t short_bytes = 46;
/// PoseSample::error of a record without an error letter that reports distortion by metal [?].
inline constexpr char distorted = '!';

struct Model {
  std::array<char, 2> letters; ///< at the beginning of each header [V]
  std::string_view name;
  double rate_hz; ///< records per second of each station, all at once
};
inline constexpr std::array models{
    Model{{'L', 'Y'}, "LIBERTY", 240.0},
    Model{{'P', 'A'}, "PATRIOT", 60.0},
    Model{{'L', 'U'}, "LIBERTY Latus", 188.0},
};

} // namespace nendo::driver::liberty
