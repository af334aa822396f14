// Decodes the URIs of glTF documents.

#include "files/gltf_document.hpp"

namespace nendo::deform {
namespace {

constexpr std::string_view data_scheme = "data:";
constexpr std::string_view base64_mark = ";base64,";

int hex_value(char c) noexcept {
  if (c >= '0' && c <= '9') return c - '0';
  if (c >= 'a' && c <= 'f') return c - 'a' + 10;
  if (c >= 'A' && c <= 'F') return c - 'A' + 10;
  return -1;
}

int base64_value(char c) noexcept {
  if (c >= 'A' && c <= 'Z') return c - 'A';
  if (c >= 'a' && c <= 'z') return c - 'a' + 26;
  if (c >= '0' && c <= '9') return c - '0' + 52;
  if (c == '+') return 62;
  return c == '/' ? 63 : -1;
}

} // namespace

std::string percent_decoded(std::string_view uri) {
  std::string text;
  for (std::size_t at = 0; at < uri.size(); ++at) {
    const bool has_two = uri[at] == '%' && at + 2 < uri.size();
    const int high = has_two ? hex_value(uri[at + 1]) : -1;
    const int low = has_two ? hex_value(uri[at + 2]) : -1;
    const bool is_byte = high >= 0 && low >= 0;
    text += is_byte ? static_cast<char>(16 * high + low) : uri[at];
    if (is_byte) at += 2;
  }
  return text;
}

bool is_data_uri(std::string_view uri) noexcept {
  return uri.starts_with(data_scheme);
}

std::optional<std::string> data_of_uri(std::string_view uri) {
  const std::size_t mark = uri.substr(0, 256).find(base64_mark);
  if (!is_data_uri(uri) || mark == std::string_view::npos) return std::nullopt;
  std::string_view digits = uri.substr(mark + base64_mark.size());
  while (digits.ends_with('='))
    digits.remove_suffix(1);
  std::string data;
  data.reserve(digits.size() / 4 * 3 + 2);
  std::uint32_t bits = 0;
  int count = 0;
  for (const char c : digits) {
    const int value = base64_value(c);
    if (value < 0) return std::nullopt;
    bits = bits << 6 | static_cast<std::uint32_t>(value);
    count += 6;
    if (count < 8) continue;
    count -= 8;
    data += static_cast<char>(bits >> count & 0xFF);
  }
  return data;
}

} // namespace nendo::deform
