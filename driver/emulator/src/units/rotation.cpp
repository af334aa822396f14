#include "units/rotation.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace nendo::emulator {
namespace {

constexpr double degree_rad = std::numbers::pi / 180.0;

} // namespace

Rotation product(const Rotation& left, const Rotation& right) noexcept {
  Rotation result{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      for (std::size_t k = 0; k < 3; ++k)
        result[row][column] += left[row][k] * right[k][column];
  return result;
}

Rotation inverse(const Rotation& rotation) noexcept {
  Rotation result{};
  for (std::size_t row = 0; row < 3; ++row)
    for (std::size_t column = 0; column < 3; ++column)
      result[row][column] = rotation[column][row];
  return result;
}

Vector3 rotated(const Rotation& rotation, const Vector3& vector) noexcept {
  return {dot(rotation[0], vector), dot(rotation[1], vector), dot(rotation[2], vector)};
}

Vector3 sum(const Vector3& a, const Vector3& b) noexcept {
  return {a[0] + b[0], a[1] + b[1], a[2] + b[2]};
}

Vector3 difference(const Vector3& a, const Vector3& b) noexcept {
  return {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
}

Vector3 scaled(const Vector3& vector, double factor) noexcept {
  return {factor * vector[0], factor * vector[1], factor * vector[2]};
}

double dot(const Vector3& a, const Vector3& b) noexcept {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

Vector3 cross(const Vector3& a, const Vector3& b) noexcept {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Rotation from_quaternion(const std::array<double, 4>& xyzw) noexcept {
  const auto [x, y, z, w] = xyzw;
  const double s = 2.0 / (x * x + y * y + z * z + w * w);
  return {{{1.0 - s * (y * y + z * z), s * (x * y - z * w), s * (x * z + y * w)},
           {s * (x * y + z * w), 1.0 - s * (x * x + z * z), s * (y * z - x * w)},
           {s * (x * z - y * w), s * (y * z + x * w), 1.0 - s * (x * x + y * y)}}};
}

// Each of the four is found from the largest one, so that no small divisor enlarges rounding.
std::array<double, 4> quaternion_wxyz(const Rotation& r) noexcept {
  const double trace = r[0][0] + r[1][1] + r[2][2];
  const std::array<double, 4> squares{1.0 + trace, 1.0 - trace + 2.0 * r[0][0],
                                      1.0 - trace + 2.0 * r[1][1], 1.0 - trace + 2.0 * r[2][2]};
  const auto largest = std::max_element(squares.begin(), squares.end());
  const double twice = std::sqrt(*largest);
  const double f = 0.5 / twice;
  const double wx = r[2][1] - r[1][2];
  const double wy = r[0][2] - r[2][0];
  const double wz = r[1][0] - r[0][1];
  const double xy = r[0][1] + r[1][0];
  const double xz = r[0][2] + r[2][0];
  const double yz = r[1][2] + r[2][1];
  std::array<double, 4> q{};
  switch (largest - squares.begin()) {
  case 0:
    q = {0.5 * twice, wx * f, wy * f, wz * f};
    break;
  case 1:
    q = {wx * f, 0.5 * twice, xy * f, xz * f};
    break;
  case 2:
    q = {wy * f, xy * f, 0.5 * twice, yz * f};
    break;
  default:
    q = {wz * f, xz * f, yz * f, 0.5 * twice};
    break;
  }
  if (q[0] < 0.0)
    for (double& part : q)
      part = -part;
  return q;
}

Rotation from_euler_deg(const Vector3& angles) noexcept {
  const double ca = std::cos(angles[0] * degree_rad);
  const double sa = std::sin(angles[0] * degree_rad);
  const double ce = std::cos(angles[1] * degree_rad);
  const double se = std::sin(angles[1] * degree_rad);
  const double cr = std::cos(angles[2] * degree_rad);
  const double sr = std::sin(angles[2] * degree_rad);
  return {{{ca * ce, ca * se * sr - sa * cr, ca * se * cr + sa * sr},
           {sa * ce, sa * se * sr + ca * cr, sa * se * cr - ca * sr},
           {-se, ce * sr, ce * cr}}};
}

Vector3 euler_deg(const Rotation& r) noexcept {
  return {std::atan2(r[1][0], r[0][0]) / degree_rad,
          std::asin(std::clamp(-r[2][0], -1.0, 1.0)) / degree_rad,
          std::atan2(r[2][1], r[2][2]) / degree_rad};
}

} // namespace nendo::emulator
