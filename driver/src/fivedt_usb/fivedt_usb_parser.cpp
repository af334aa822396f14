#include "fivedt_usb/fivedt_usb_parser.hpp"

#include <algorithm>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::fivedt_usb {

std::optional<Report> decode_report(std::span<const std::byte> report) noexcept {
  if (report.size() != report_bytes) return std::nullopt;
  ByteReader reader(report);
  Report decoded;
  for (std::uint16_t& value : decoded.values) {
    const unsigned high = reader.u8();
    const int read = static_cast<std::int16_t>(high << 8U | reader.u8());
    value = static_cast<std::uint16_t>(std::clamp<int>(read, 0, most_count));
  }
  return decoded;
}

} // namespace nendo::driver::fivedt_usb
