#include "cyberglove/hi_res_record.hpp"

#include <algorithm>
#include <string_view>

#include <nendo/base/byte_reader.hpp>

namespace nendo::driver::cyberglove {
namespace {

constexpr std::string_view time_pattern = "00:00:00:00:0S"; ///< 0 stands for any digit
constexpr std::string_view tail{"\r\n\0", 3};
static_assert(time_pattern.size() == hi_res_time_bytes);

constexpr int frames_per_second = 30;
constexpr int sub_frames = 10; ///< that one digit can tell apart

int number_at(std::span<const std::byte> bytes, std::size_t tens) noexcept {
  const auto digit = [&](std::size_t k) { return std::to_integer<int>(bytes[k]) - '0'; };
  return 10 * digit(tens) + digit(tens + 1);
}

/// `last` is the place of the last byte, a digit or what stands between digits.
bool continues_time(std::span<const std::byte> bytes, std::size_t last) noexcept {
  const auto c = std::to_integer<char>(bytes[last]);
  if (time_pattern[last] != '0') return c == time_pattern[last];
  if (c < '0' || c > '9') return false;
  switch (last) {
  case 1:
    return number_at(bytes, 0) < 24;
  case 4:
    return number_at(bytes, 3) < 60;
  case 7:
    return number_at(bytes, 6) < 60;
  case 10:
    return number_at(bytes, 9) <= frames_per_second;
  default:
    return true;
  }
}

} // namespace

bool continues_hi_res(std::span<const std::byte> bytes) noexcept {
  constexpr std::size_t values_end = hi_res_bytes - tail.size();
  const std::size_t last = bytes.size() - 1;
  if (last < hi_res_time_bytes) return continues_time(bytes, last);
  if (last >= values_end) return std::to_integer<char>(bytes[last]) == tail[last - values_end];
  const bool high = (last - hi_res_time_bytes) % 2 == 0;
  return !high || std::to_integer<unsigned>(bytes[last]) <= hi_res_max >> 8U;
}

bool begins_hi_res(std::span<const std::byte> bytes) noexcept {
  for (std::size_t count = 1; count <= bytes.size(); ++count) {
    if (!continues_hi_res(bytes.first(count))) return false;
  }
  return true;
}

Record read_hi_res(std::span<const std::byte> frame) noexcept {
  using namespace std::chrono;
  Record record;
  const auto whole =
      hours(number_at(frame, 0)) + minutes(number_at(frame, 3)) + seconds(number_at(frame, 6));
  const int frames = number_at(frame, 9);
  const int sub_frame = std::to_integer<int>(frame[12]) - '0';
  record.time_of_day = whole + nanoseconds(seconds(sub_frames * frames + sub_frame)) /
                                   (frames_per_second * sub_frames);
  record.second = static_cast<std::uint32_t>(whole.count());
  record.frame = static_cast<std::uint8_t>(frames);
  record.sub_frame = static_cast<std::uint8_t>(sub_frame);
  ByteReader reader(frame.subspan(hi_res_time_bytes));
  for (std::size_t k = 0; k < hi_res_values; ++k) {
    const unsigned high = reader.u8();
    const auto value = static_cast<std::uint16_t>(high << 8U | reader.u8());
    record.values[k] = std::max<std::uint16_t>(value, 1);
    record.clamped += value == 0 ? 1U : 0U;
  }
  record.no_glove = record.clamped == hi_res_values;
  return record;
}

} // namespace nendo::driver::cyberglove
