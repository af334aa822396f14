#include "fivedt_usb/fivedt_usb_parser.hpp"

#include <algorithm>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::fivedt_usb {

std::optional<Report> decode_report(std::span<const std::byte> report) noexcept {
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

} // namespace nendo::driver::fivedt_usb
