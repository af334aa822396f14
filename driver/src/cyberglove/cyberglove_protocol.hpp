#pragma once
// The CyberGlove's serial protocol. The manual is out of print, so each fact names its source:
//   [V]  Virtual Technologies' own host library, 1990-93
//   [p.] the page of the CyberGlove manual, as authors of drivers cite it who had the manual
//   [D]  two or more independent drivers that ran on real gloves

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include <nendo/driver/sample.hpp>

namespace nendo::driver::cyberglove {

/// Ends every reply and every record. It occurs nowhere else in a record [V, D], but may occur in a
/// reply [V].
inline constexpr std::byte terminator{0x00};

// Control commands, a single byte each.
inline constexpr std::byte interrupt{0x03}; ///< ^C: ends a stream; answered 03 00 [V, D]
/// ^I: read the glove's memory again, after a swap [V].
inline constexpr std::string_view reread_glove = "\x09";

inline constexpr std::string_view stream_command =
    "S"; ///< one record after the other until `interrupt` [D]

// Settings are a letter and raw bytes. They are answered by the letter and NUL [D], or with a byte
// between them [V]. In text they are the small letter, decimal numbers and CR.
inline constexpr std::string_view set_software_mask = "M"; ///< 3 bytes, LSB first [V, D]
inline constexpr std::string_view set_value_count = "N";   ///< 1 byte [V, D]
/// bool: records begin with Y and come at the pulses of the sync input; refused by `ey` if these
/// are too fast [V].
inline constexpr std::string_view set_sync = "Y";
inline constexpr std::string_view set_period_text = "t"; ///< two numbers; T's order is disputed
inline constexpr std::string_view set_vibration = "A";   ///< count, so many pairs index, value [D]
inline constexpr std::uint8_t all_vibrators = 0xFF;      ///< a count: then 6 values follow [D]

/// On-off settings. The letter and a byte of 0 or 1 sets one, '?' and the letter asks for it.
enum class Setting : char {
  time_stamp = 'D',          ///< append the time stamp [V, p.28]
  filter = 'F',              ///< digital filter, on at power-up; slows the sampling [V, p.29]
  switch_drives_light = 'J', ///< on at power-up [V, p.35]
  light = 'L',               ///< at the wrist [V]
  quantised = 'Q',           ///< send values calibrated by what 'C' has set [D]
  status_byte = 'U',         ///< append the status byte [V, p.50]
  wrist_switch = 'W',        ///< as the software sees it [V, p.52]
};

struct GloveState {
  bool initialised = false;
  bool connected = false; ///< a glove is plugged into the unit
};

using Vibration = std::array<std::uint8_t, 6>; ///< thumb to little finger, palm

// Queries are '?' and a letter. They are answered by both, data of fixed length, and NUL [V, D].
/// A query whose data mean a `T`.
template <class T>
struct Query {
  char letter;
  std::size_t data_bytes;
};
inline constexpr Query<GloveState> ask_state{'G', 1};          ///< bits below [V, p.31]
inline constexpr Query<std::uint8_t> ask_sensor_count{'S', 1}; ///< 18 or 22 [V, D]
inline constexpr Query<SensorMask> ask_hardware_mask{'K', 3};  ///< sensors built in, LSB first [V]
inline constexpr Query<SensorMask> ask_software_mask{'M', 3};  ///< sensors wanted, LSB first [V]
inline constexpr Query<std::uint8_t> ask_value_count{'N', 1};  ///< only so many are sent [V]
inline constexpr Query<Side> ask_side{'R', 1};                 ///< 1: right [V]
/// Two 16-bit words, see decode_period(); byte order disputed [p.47].
inline constexpr Query<std::array<std::byte, 4>> ask_period{'T', 4};
inline constexpr Query<std::uint32_t> ask_parameters{'P', 3}; ///< flags, LSB first [V, two drivers]
/// Two 16-bit words, meaning unknown [D].
inline constexpr Query<std::array<std::uint8_t, 4>> ask_firmware{'V', 4};
inline constexpr Query<std::uint8_t> ask_baud{'B', 1};   ///< see baud_of_register() [V]
inline constexpr Query<Vibration> ask_vibration{'A', 6}; ///< [D]
inline constexpr char ask_calibration = 'C';   ///< an offset a sensor, then a gain a sensor [D]
inline constexpr char ask_information = 'i';   ///< text of several lines; NUL ends it [V, D]
inline constexpr char ask_firmware_text = 'v'; ///< text [V]

// Commands of the CyberGlove III only. They are answered by the same and NUL [D]; but 1S without
// NUL, and the `interrupt` that ends its stream by one byte [two drivers].
inline constexpr std::string_view third_enable_usb = "1eu"; ///< 12-bit records over the cable
inline constexpr std::string_view third_frame_rate = "1m";  ///< a byte: so many times 30 Hz
inline constexpr std::string_view third_stream = "1S";      ///< 12-bit records until `interrupt`
inline constexpr double third_frame_step_hz = 30.0;

// The bits of the reply to ?G; both: a working glove [V, p.31].
inline constexpr std::uint8_t state_initialised = 0x01;
inline constexpr std::uint8_t state_connected = 0x02;

// The flags of ?P: their bits. The lowest byte is the status byte, as records carry it.
inline constexpr unsigned flag_wrist_switch = 1;
inline constexpr unsigned flag_light = 2;
inline constexpr unsigned flag_status_byte = 10;
inline constexpr unsigned flag_switch_drives_light = 11;
inline constexpr unsigned flag_filter = 12;
inline constexpr unsigned flag_time_stamp = 13;
inline constexpr unsigned flag_quantised = 16;
inline constexpr unsigned flag_cybertouch = 17; ///< vibrators are built in

// Errors have two letters each. They occur as replies and within records [V, D].
inline constexpr char error_mark = 'e';
inline constexpr char error_unknown_command = '?';
inline constexpr char error_number = 'n';
inline constexpr char error_sync_rate = 'y';
inline constexpr char error_no_glove = 'g';
inline constexpr char error_sampling_rate = 's';

// A record: header, values 1..255, time stamp if on, status if on, error pairs if any, NUL [V,
// p.28, p.50]. The header is the letter that asked for it.
inline constexpr char polled_header = 'G'; ///< [V, D]
inline constexpr char stream_header = 'S'; ///< [V, D]
inline constexpr char synced_header = 'Y'; ///< at the pace of an external signal [V]
inline constexpr std::size_t max_values = sensor_slots;
inline constexpr std::size_t time_stamp_bytes = 5; ///< flags, then the ticks LSB first [V, p.28]
inline constexpr std::size_t max_error_bytes = 4;  ///< one pair of each kind [V]

// The status byte [p.41].
inline constexpr std::uint8_t status_plugged_in = 0x01;
inline constexpr std::uint8_t status_switch = 0x02;
inline constexpr std::uint8_t status_reserved = 0x78;
inline constexpr std::uint8_t status_always = 0x80; ///< always set

// The CyberGlove III's high-resolution record: `HH:MM:SS:FF:nS`, 22 values of 12 bits, most
// significant byte first, never 0, then CR LF NUL. Its values hold NULs. [Two drivers.]
inline constexpr std::size_t hi_res_time_bytes = 14;
inline constexpr std::size_t hi_res_values = 22;
inline constexpr std::uint16_t hi_res_max = 0x0FFF;
inline constexpr std::size_t hi_res_bytes = hi_res_time_bytes + 2 * hi_res_values + 3;

/// The longest record of either form.
inline constexpr std::size_t max_record_bytes = hi_res_bytes;

/// Returns the switch's position from a record's status byte, which is 0 if the record has none.
constexpr WristSwitch wrist_switch_of(std::uint8_t status) noexcept {
  if (status == 0) return WristSwitch::unknown;
  return (status & status_switch) != 0 ? WristSwitch::on : WristSwitch::off;
}

inline constexpr double clock_hz = 115'200.0; ///< the clock of period [p.47] and time stamp [p.28]

} // namespace nendo::driver::cyberglove
