#pragma once
// The Essential Reality P5 (2002): a glove at an infrared receiver that is a USB device. The maker
// has published no document. All facts here are what the published host library of 2003-05 and its
// successors read from real gloves.

#include <array>
#include <cstddef>
#include <cstdint>

#include <nendo/driver/sample.hpp>

#include "transport/usb_transport.hpp"

namespace nendo::driver::p5 {

inline constexpr UsbId usb_id{0x0D7F, 0x0100};

/// Interface 0 is the mouse that a P5 also is.
inline constexpr int interface_number = 1;

// The only input report. Its fields follow each other without gaps, from the most significant bit
// of the first byte on.
inline constexpr std::size_t report_bytes = 24;
inline constexpr std::uint8_t report_id = 1;

inline constexpr std::size_t bends_at = 8; ///< bits from the report's begin
inline constexpr std::size_t bend_bits = 6;
inline constexpr std::uint16_t max_bend = 63; ///< a clenched finger; 0 is a straight one
/// The sensors in the report's order. Each lies along a whole finger, and its curl counts as that
/// of the knuckle, by which the hand's model bends the other joints.
inline constexpr std::array bend_sensors{Sensor::index_mcp, Sensor::middle_mcp, Sensor::ring_mcp,
                                         Sensor::little_mcp, Sensor::thumb_mcp};

inline constexpr std::size_t buttons_at = 40;
inline constexpr std::size_t buttons_bits = 4;
inline constexpr std::uint8_t button_a = 0x1;
// The rest, the views of the receiver's lenses of the glove's infrared lights, is not used.

// Feature report 5 says whether the glove moves the mouse. It can be read and set.
inline constexpr std::byte mouse_report{5};
inline constexpr std::byte mouse_on{0x01};
inline constexpr std::byte mouse_off{0xFF};

} // namespace nendo::driver::p5
