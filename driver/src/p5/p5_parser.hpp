#pragma once
// Decodes the P5's input report. It is pure (no I/O, clock, log or allocation), and bytes are not
// trusted.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <nendo/driver/sample.hpp>

#include "stream/stream_parser.hpp"
#include "transport/usb_transport.hpp"

namespace nendo::driver::p5 {
// The Essential Reality P5 (2002): a glove at an infrared receiver that is a USB device. The maker
// has published no document. All facts here are what the published host library of 2003-05 and its
// successors read from real gloves.

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

struct Report {
  std::array<std::uint8_t, bend_sensors.size()> bends{}; ///< in the order of bend_sensors
  bool button_a = false;
};

/// Returns the `count` bits from bit `at`; bit 0 is the most significant one of byte 0.
constexpr std::uint16_t bits(std::span<const std::byte> report, std::size_t at,
                             std::size_t count) noexcept {
  unsigned value = 0;
  for (std::size_t k = at; k < at + count; ++k) {
    const auto byte = std::to_integer<unsigned>(report[k / 8]);
    value = value << 1U | (byte >> (7 - k % 8) & 1U);
  }
  return static_cast<std::uint16_t>(value);
}

/// Returns nullopt if the report has another length or another number.
inline std::optional<Report> decode_report(std::span<const std::byte> report) noexcept {
  if (report.size() != report_bytes || report[0] != std::byte{report_id}) return std::nullopt;
  Report decoded;
  for (std::size_t k = 0; k < decoded.bends.size(); ++k) {
    decoded.bends[k] = static_cast<std::uint8_t>(bits(report, bends_at + k * bend_bits, bend_bits));
  }
  decoded.button_a = (bits(report, buttons_at, buttons_bits) & button_a) != 0;
  return decoded;
}

using Parser = ReportParser<Report, decode_report>;

} // namespace nendo::driver::p5
