#pragma once
// The CyberGlove's serial protocol. The manual itself is out of print; each fact names who states
// it:
//   [V]  Virtual Technologies' own host library, 1990-93
//   [p.] the page of the CyberGlove manual, as drivers cite it that were written with the manual at
//   hand [D]  two or more independent drivers that ran on real gloves

#include <cstddef>
#include <cstdint>

#include <nendo/driver/sample.hpp>

namespace nendo::driver::cyberglove {

/// Ends every reply and every record, and occurs nowhere else inside a record [V, D]. Inside a
/// reply it may [V].
inline constexpr std::byte terminator{0x00};

// Control commands, a single byte each.
inline constexpr std::byte interrupt{0x03}; ///< ^C: ends a stream; answered 03 00 [V, D]
inline constexpr std::byte reread_glove{
    0x09}; ///< ^I: read the glove's memory anew, after a swap [V]

inline constexpr char stream_command = 'S'; ///< one record after the other until `interrupt` [D]

// Settings: the letter and raw bytes; answered by the letter and NUL [D], or with a byte between
// them [V].
inline constexpr char set_time_stamp = 'D'; ///< bool: append the time stamp [p.28]
inline constexpr char set_status = 'U';     ///< bool: append the status byte [p.50]

// Queries: '?' and the letter; answered by both, data of fixed length, NUL [V, D].
struct Query {
  char letter;
  std::size_t data_bytes;
};
inline constexpr Query ask_state{'G', 1};         ///< bits below; 3 is a working glove [V, p.31]
inline constexpr Query ask_sensor_count{'S', 1};  ///< 18 or 22 [V, D]
inline constexpr Query ask_hardware_mask{'K', 3}; ///< sensors built in, LSB first [V]
inline constexpr Query ask_software_mask{'M', 3}; ///< sensors wanted, LSB first [V]
inline constexpr Query ask_value_count{'N', 1};   ///< only the first so many are sent [V]
inline constexpr Query ask_right_hand{'R', 1};    ///< 1: right [V]
inline constexpr Query ask_period{'T', 4};        ///< two 16-bit words, byte order disputed [p.47]
inline constexpr char ask_information = 'i';      ///< text of several lines; NUL ends it [V, D]

inline constexpr std::uint8_t state_initialised = 0x01; ///< of ?G [V, p.31]
inline constexpr std::uint8_t state_connected = 0x02;   ///< of ?G [V, p.31]

// Errors, two letters each, for replies and within records [V, D].
inline constexpr char error_mark = 'e';
inline constexpr char error_unknown_command = '?';
inline constexpr char error_number = 'n';
inline constexpr char error_sync_rate = 'y';
inline constexpr char error_no_glove = 'g';
inline constexpr char error_sampling_rate = 's';

// A record: header, values 1..255, time stamp if on, status if on, error pairs if any, NUL [V,
// p.28, p.50].
inline constexpr std::size_t most_values = sensor_slots;
inline constexpr std::size_t time_stamp_bytes = 5; ///< flags, then the ticks LSB first [V, p.28]
inline constexpr std::size_t most_error_bytes = 4; ///< one pair of each kind [V]
inline constexpr std::size_t most_record_bytes =
    1 + most_values + time_stamp_bytes + 1 + most_error_bytes + 1;
inline constexpr std::uint8_t status_always =
    0x80; ///< bit 7 of the status byte is always set [p.41]

inline constexpr double clock_hz = 115'200.0; ///< of the period [p.47] and the time stamp [p.28]

} // namespace nendo::driver::cyberglove
