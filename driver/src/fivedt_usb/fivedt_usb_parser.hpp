#pragma once
// Decodes the 5DT Ultra's input report. It is pure (no I/O, clock, log or allocation), and bytes
// are not trusted.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "fivedt_usb/fivedt_usb_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::fivedt_usb {

struct Report {
  /// Values from 0 to max_count, in the order of value_sensors. Values outside that range are set
  /// to the nearer end, and marked.
  std::array<std::uint16_t, value_sensors.size()> values{};
  std::array<bool, value_sensors.size()> clamped{};
};

/// Returns nullopt if the report has another length. Damaged values look like good ones.
std::optional<Report> decode_report(std::span<const std::byte> report) noexcept;

using Parser = ReportParser<Report, decode_report>;

} // namespace nendo::driver::fivedt_usb
