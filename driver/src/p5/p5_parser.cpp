#include "p5/p5_parser.hpp"

namespace nendo::driver::p5 {
namespace {

using Bytes = std::span<const std::byte, report_bytes>;

/// The `count` bits from bit `at` on; bit 0 is the most significant one of byte 0.
constexpr std::uint16_t bits(Bytes report, std::size_t at, std::size_t count) noexcept {
  unsigned value = 0;
  for (std::size_t k = at; k < at + count; ++k) {
    const auto byte = std::to_integer<unsigned>(report[k / 8]);
    value = value << 1U | (byte >> (7 - k % 8) & 1U);
  }
  return static_cast<std::uint16_t>(value);
}

constexpr std::int16_t view(Bytes report, std::size_t at) noexcept {
  const int value = bits(report, at, view_bits);
  return static_cast<std::int16_t>(value < 512 ? value : value - 1024);
}

} // namespace

std::optional<Report> decode_report(std::span<const std::byte> report) noexcept {
  if (report.size() != report_bytes || report[0] != std::byte{report_id}) return std::nullopt;
  const Bytes bytes = report.first<report_bytes>();
  Report decoded;
  for (std::size_t k = 0; k < decoded.bends.size(); ++k) {
    decoded.bends[k] = static_cast<std::uint8_t>(bits(bytes, bends_at + k * bend_bits, bend_bits));
  }
  const unsigned buttons = bits(bytes, buttons_at, buttons_bits);
  decoded.button_a = (buttons & button_a) != 0;
  decoded.button_b = (buttons & button_b) != 0;
  decoded.button_c = (buttons & button_c) != 0;
  for (std::size_t k = 0; k < max_lights; ++k) {
    const unsigned number = bits(bytes, lights_at + k * light_bits, light_bits);
    if ((number & no_light) != 0) continue;
    const std::size_t at = views_at + 3 * k * view_bits;
    decoded.lights[decoded.light_count++] = {static_cast<std::uint8_t>(number), view(bytes, at),
                                             view(bytes, at + view_bits),
                                             view(bytes, at + 2 * view_bits)};
  }
  return decoded;
}

} // namespace nendo::driver::p5
