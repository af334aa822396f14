#include "p5/p5_parser.hpp"

namespace nendo::driver::p5 {
namespace {

using Bytes = std::span<const std::byte, report_bytes>;

/// Returns the `count` bits from bit `at`; bit 0 is the most significant one of byte 0.
constexpr std::uint16_t bits(Bytes report, std::size_t at, std::size_t count) noexcept {
  unsigned value = 0;
  for (std::size_t k = at; k < at + count; ++k) {
    const auto byte = std::to_integer<unsigned>(report[k / 8]);
    value = value << 1U | (byte >> (7 - k % 8) & 1U);
  }
  return static_cast<std::uint16_t>(value);
}

} // namespace

std::optional<Report> decode_report(std::span<const std::byte> report) noexcept {
  if (report.size() != report_bytes || report[0] != std::byte{report_id}) return std::nullopt;
  const Bytes bytes = report.first<report_bytes>();
  Report decoded;
  for (std::size_t k = 0; k < decoded.bends.size(); ++k) {
    decoded.bends[k] = static_cast<std::uint8_t>(bits(bytes, bends_at + k * bend_bits, bend_bits));
  }
  decoded.button_a = (bits(bytes, buttons_at, buttons_bits) & button_a) != 0;
  return decoded;
}

} // namespace nendo::driver::p5
