#pragma once
// Decodes the 5DT Ultra's input report. It is pure (no I/O, clock, log or allocation), and bytes
// are not trusted.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include <nendo/base/byte_reader.hpp>
#include <nendo/driver/sample.hpp>

#include "stream/stream_parser.hpp"

namespace nendo::driver::fivedt_usb {
// The 5DT Data Glove Ultra at USB, by cable or by its wireless kit's receiver: a HID device. Its
// facts are those of VRPN's driver, which ran on gloves of 5 sensors; the maker publishes none.

inline constexpr std::uint16_t vendor_id = 0x5D70;
inline constexpr int interface_number = 0;

// The product number has hand, link and sensors.
inline constexpr unsigned left_bit = 0x01;
inline constexpr unsigned link_bits = 0x06; ///< none: cable; 0x02: wireless port A; 0x06: port B
inline constexpr unsigned port_a = 0x02;
inline constexpr unsigned port_b = 0x06;
inline constexpr unsigned five_sensors_bit = 0x10; ///< else 14

enum class Link : std::uint8_t { cable, wireless_a, wireless_b };

struct Model {
  Side side = Side::right;
  Link link = Link::cable;
  bool five_sensors = false;
  friend constexpr bool operator==(const Model&, const Model&) = default;
};

/// Returns nullopt if no glove has this number.
constexpr std::optional<Model> model_of(std::uint16_t product_id) noexcept {
  if ((product_id & ~(left_bit | link_bits | five_sensors_bit)) != 0) return std::nullopt;
  const unsigned link = product_id & link_bits;
  if (link != 0 && link != port_a && link != port_b) return std::nullopt;
  return Model{(product_id & left_bit) != 0 ? Side::left : Side::right,
               link == 0        ? Link::cable
               : link == port_a ? Link::wireless_a
                                : Link::wireless_b,
               (product_id & five_sensors_bit) != 0};
}

// The input report has 16 signed values of two bytes, high byte first. The rest is not known. It
// has no number.
inline constexpr std::size_t report_bytes = 64;
inline constexpr std::uint16_t max_count = 4095;

/// The sensor of value k in a glove of 14 sensors; the last two values belong to no sensor. A glove
/// of 5 has one sensor along each finger, which counts as the knuckle's: values 0, 3, 6, 9 and 12.
inline constexpr std::array value_sensors{
    Sensor::thumb_mcp,  Sensor::thumb_ip,   Sensor::thumb_abduction,
    Sensor::index_mcp,  Sensor::index_pip,  Sensor::index_middle_abduction,
    Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_ring_abduction,
    Sensor::ring_mcp,   Sensor::ring_pip,   Sensor::ring_little_abduction,
    Sensor::little_mcp, Sensor::little_pip};
inline constexpr std::size_t values_per_finger = 3;

struct Report {
  /// Values from 0 to max_count, in the order of value_sensors. Values outside that range are set
  /// to the nearer end, and marked.
  std::array<std::uint16_t, value_sensors.size()> values{};
  std::array<bool, value_sensors.size()> clamped{};
};

/// Returns nullopt if the report has another length. Damaged values look like good ones.
inline std::optional<Report> decode_report(std::span<const std::byte> report) noexcept {
  if (report.size() != report_bytes) return std::nullopt;
  ByteReader reader(report);
  Report decoded;
  for (std::size_t k = 0; k < decoded.values.size(); ++k) {
    const unsigned high = reader.u8();
    const int read = static_cast<std::int16_t>(high << 8U | reader.u8());
    decoded.values[k] = static_cast<std::uint16_t>(std::clamp<int>(read, 0, max_count));
    decoded.clamped[k] = read != decoded.values[k];
  }
  return decoded;
}

using Parser = ReportParser<Report, decode_report>;

} // namespace nendo::driver::fivedt_usb
