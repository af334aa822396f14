#pragma once
// Decodes the P5's input report. It is pure (no I/O, clock, log or allocation), and bytes are not
// trusted.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>

#include "p5/p5_protocol.hpp"
#include "stream/report_parser.hpp"

namespace nendo::driver::p5 {

/// Where the receiver sees one of the glove's lights: tangents in units of 1/512, seen by the upper
/// and lower (v1, v2) and by the level lens (h). They run from about -615 to 615, of which a report
/// holds ten bits, so that they wrap around beyond -512 and 511.
struct SeenLight {
  std::uint8_t number = 0; ///< 0 to 7
  std::int16_t v2 = 0;
  std::int16_t v1 = 0;
  std::int16_t h = 0;
  friend bool operator==(const SeenLight&, const SeenLight&) = default;
};

struct Report {
  std::array<std::uint8_t, bend_sensors.size()> bends{}; ///< in the order of bend_sensors
  bool button_a = false;
  bool button_b = false;
  bool button_c = false;
  std::array<SeenLight, max_lights> lights{}; ///< the first `light_count` are set
  std::size_t light_count = 0;
};

/// Returns nullopt if the report has another length or another number.
std::optional<Report> decode_report(std::span<const std::byte> report) noexcept;

using Parser = ReportParser<Report, decode_report>;

} // namespace nendo::driver::p5
