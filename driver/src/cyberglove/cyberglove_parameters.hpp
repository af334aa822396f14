#pragma once
// The parameter flags of 'P' and ?P: three bytes, LSB first [V, two drivers].

#include <array>
#include <cstdint>

#include <nendo/driver/sample.hpp>

namespace nendo::driver::cyberglove {

struct Parameters {
  // The glove's status byte, as records carry it.
  bool plugged_in = false; ///< read only
  bool wrist_switch = false;
  bool light = false;
  // Settings.
  bool sync = false;      ///< 'Y'
  bool text_sync = false; ///< 'y'
  bool status_byte = false;
  bool switch_drives_light = false;
  bool filter = false;
  bool time_stamp = false;
  bool right_hand = false;  ///< read only
  bool glove_valid = false; ///< read only
  bool quantised = false;
  bool cybertouch = false; ///< read only: vibrators are built in
  friend bool operator==(const Parameters&, const Parameters&) = default;
};

struct ParameterBit {
  bool Parameters::* flag;
  unsigned bit;
};
inline constexpr std::array parameter_bits{
    ParameterBit{&Parameters::plugged_in, 0},
    ParameterBit{&Parameters::wrist_switch, 1},
    ParameterBit{&Parameters::light, 2},
    ParameterBit{&Parameters::sync, 8},
    ParameterBit{&Parameters::text_sync, 9},
    ParameterBit{&Parameters::status_byte, 10},
    ParameterBit{&Parameters::switch_drives_light, 11},
    ParameterBit{&Parameters::filter, 12},
    ParameterBit{&Parameters::time_stamp, 13},
    ParameterBit{&Parameters::right_hand, 14},
    ParameterBit{&Parameters::glove_valid, 15},
    ParameterBit{&Parameters::quantised, 16},
    ParameterBit{&Parameters::cybertouch, 17},
};
inline constexpr std::uint32_t parameter_always = 1U << 7U; ///< set in every status byte [p.41]

constexpr Parameters decode_parameters(std::uint32_t bits) noexcept {
  Parameters parameters;
  for (const ParameterBit& entry : parameter_bits)
    parameters.*entry.flag = (bits >> entry.bit & 1U) != 0;
  return parameters;
}

constexpr std::uint32_t encode_parameters(const Parameters& parameters) noexcept {
  std::uint32_t bits = parameter_always;
  for (const ParameterBit& entry : parameter_bits)
    bits |= static_cast<std::uint32_t>(parameters.*entry.flag) << entry.bit;
  return bits;
}

/// Returns the switch's position from a record's status byte, which is 0 if the record has none.
constexpr WristSwitch wrist_switch_of(std::uint8_t status) noexcept {
  if (status == 0) return WristSwitch::unknown;
  return decode_parameters(status).wrist_switch ? WristSwitch::on : WristSwitch::off;
}

} // namespace nendo::driver::cyberglove
