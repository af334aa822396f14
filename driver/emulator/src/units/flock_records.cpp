// Chosen where published facts say nothing: a matrix is sent row by row, and it is, as the
// quaternion is, the one that turns vectors of the transmitter into those of the receiver.

#include "units/flock_records.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string_view>
#include <vector>

namespace nendo::emulator::flock {
namespace {

using unit::Byte;

constexpr std::string_view formats = "VWXYZ\\]";

bool has_position(Byte format) {
  return std::string_view("VYZ]").find(static_cast<char>(format)) != std::string_view::npos;
}
bool has_angles(Byte format) {
  return format == 'W' || format == 'Y';
}
bool has_matrix(Byte format) {
  return format == 'X' || format == 'Z';
}

/// Two bytes of seven bits, low one first: the upper 14 bits of a word of 16. The positive full
/// scale is one more than the highest word, and becomes the lowest.
void append_value(unit::Message& message, double part) {
  const double steps = std::clamp(part, -1.0, 1.0) * 8192.0;
  const auto bits = static_cast<unsigned>(std::lround(steps)) & 0x3FFFU;
  message.push_back(static_cast<Byte>(bits & 0x7FU));
  message.push_back(static_cast<Byte>(bits >> 7U));
}

} // namespace

bool is_format(Byte letter) noexcept {
  return formats.find(static_cast<char>(letter)) != std::string_view::npos;
}

unit::Message record_values(Byte format, const ReceiverInches& pose, double range_in) {
  std::vector<double> parts;
  if (has_position(format))
    for (const double place_in : pose.position_in)
      parts.push_back(place_in / range_in);
  if (has_angles(format))
    for (const double angle_deg : euler_deg(pose.attitude))
      parts.push_back(angle_deg / 180.0);
  const Rotation turned = inverse(pose.attitude);
  if (has_matrix(format))
    for (const Vector3& row : turned)
      parts.insert(parts.end(), row.begin(), row.end());
  if (!has_angles(format) && !has_matrix(format) && format != 'V')
    for (const double part : quaternion_wxyz(turned))
      parts.push_back(part);
  unit::Message message;
  for (const double part : parts)
    append_value(message, part);
  message.front() = static_cast<Byte>(message.front() | 0x80U);
  return message;
}

} // namespace nendo::emulator::flock
