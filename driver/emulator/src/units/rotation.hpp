#pragma once
// Rotations as emulated trackers report them. Matrices turn vectors of a receiver into those of a
// transmitter.

#include <array>

namespace nendo::emulator {

using Vector3 = std::array<double, 3>;
using Rotation = std::array<Vector3, 3>; ///< a matrix, row by row

inline constexpr Rotation no_rotation{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

Rotation product(const Rotation& left, const Rotation& right) noexcept;
Rotation inverse(const Rotation& rotation) noexcept;
Vector3 rotated(const Rotation& rotation, const Vector3& vector) noexcept;

Vector3 sum(const Vector3& a, const Vector3& b) noexcept;
Vector3 difference(const Vector3& a, const Vector3& b) noexcept;
Vector3 scaled(const Vector3& vector, double factor) noexcept;
double dot(const Vector3& a, const Vector3& b) noexcept;
Vector3 cross(const Vector3& a, const Vector3& b) noexcept;

/// The quaternion need not have the norm 1.
Rotation from_quaternion(const std::array<double, 4>& xyzw) noexcept;
/// Returns w x y z with w >= 0.
std::array<double, 4> quaternion_wxyz(const Rotation& rotation) noexcept;

/// Azimuth, elevation and roll in degrees: a turn about z, then about the new y, then about the new
/// x, all right-handed.
Rotation from_euler_deg(const Vector3& angles) noexcept;
Vector3 euler_deg(const Rotation& rotation) noexcept;

} // namespace nendo::emulator
