#pragma once
// Decodes the P5's input report. It is pure (no I/O, clock, log or allocation), and bytes are not
// trusted.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "p5/p5_protocol.hpp"
#include "stream/stream_parser.hpp"

namespace nendo::driver::p5 {

struct Report {
  std::array<std::uint8_t, bend_sensors.size()> bends{}; ///< in the order of bend_sensors
  bool button_a = false;
};

/// Returns nullopt if the report has another length or another number.
std::optional<Report> decode_report(std::span<const std::byte> report) noexcept;

using Parser = ReportParser<Report, decode_report>;

} // namespace nendo::driver::p5
