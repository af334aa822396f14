#include "units/capture.hpp"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string_view>
#include <system_error>

namespace nendo::emulator {
namespace {

constexpr std::uintmax_t max_bytes = 64U << 20U;
// A text record of 24 values with time stamp, status and errors has 130.
constexpr std::ptrdiff_t max_record_bytes = 160;

} // namespace

std::vector<unit::Message> cut_records(std::span<const std::byte> bytes) {
  constexpr std::string_view letters = "GgSsYy";
  std::vector<unit::Message> records;
  for (auto begin = bytes.begin();;) {
    const auto end = std::find(begin, bytes.end(), std::byte{0});
    if (end == bytes.end()) return records;
    const bool record = letters.find(static_cast<char>(*begin)) != std::string_view::npos;
    // Two bytes are the reply to a setting.
    if (record && end - begin >= 2 && end - begin < max_record_bytes) {
      auto& bytes_of = records.emplace_back();
      std::for_each(begin, end + 1,
                    [&](std::byte byte) { bytes_of.push_back(std::to_integer<unit::Byte>(byte)); });
    }
    begin = end + 1;
  }
}

Result<std::vector<unit::Message>> read_capture(const std::string& path) {
  const auto bad = [&path](const std::string& why) {
    return Error{Errc::bad_input, "replay " + path + ": " + why};
  };
  std::error_code error;
  if (!std::filesystem::is_regular_file(path, error)) return bad("there is no such file");
  const auto size = std::filesystem::file_size(path, error);
  if (error) return bad(error.message());
  if (size > max_bytes) return bad("it is larger than 64 MiB; give a part of it");
  std::vector<char> bytes(size);
  std::ifstream file(path, std::ios::binary);
  if (!file.read(bytes.data(), static_cast<std::streamsize>(size))) return bad("cannot read it");
  auto records = cut_records(std::as_bytes(std::span(bytes)));
  if (records.empty()) {
    return bad("there is no record in it; it must hold the bytes as a host received them");
  }
  return records;
}

} // namespace nendo::emulator
