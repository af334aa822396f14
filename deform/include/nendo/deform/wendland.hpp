#pragma once
// Wendland's radial functions with compact support, which are positive definite in R^3, normalised
// to psi(0) = 1 (Wendland 1995). t = |x - c| / r; all functions are zero for t >= 1.

#include <optional>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo::deform {

enum class Wendland { c0, c2, c4, c6 };

/// Returns psi(t) for t >= 0.
constexpr double wendland(Wendland kernel, double t) noexcept {
  if (!(t < 1.0)) return 0.0;
  const double u = 1.0 - t;
  const double u2 = u * u;
  switch (kernel) {
  case Wendland::c0:
    return u2;
  case Wendland::c2:
    return u2 * u2 * (4.0 * t + 1.0);
  case Wendland::c4:
    return u2 * u2 * u2 * ((35.0 * t + 18.0) * t + 3.0) / 3.0;
  case Wendland::c6:
    return u2 * u2 * u2 * u2 * (((32.0 * t + 25.0) * t + 8.0) * t + 1.0);
  }
  return 0.0;
}

/// Returns psi'(t) for t >= 0. For c0, which has no derivative at t = 0, it is the right derivative
/// there.
constexpr double wendland_slope(Wendland kernel, double t) noexcept {
  if (!(t < 1.0)) return 0.0;
  const double u = 1.0 - t;
  const double u2 = u * u;
  switch (kernel) {
  case Wendland::c0:
    return -2.0 * u;
  case Wendland::c2:
    return -20.0 * t * u2 * u;
  case Wendland::c4:
    return -56.0 / 3.0 * t * u2 * u2 * u * (5.0 * t + 1.0);
  case Wendland::c6:
    return -22.0 * t * u2 * u2 * u2 * u * ((16.0 * t + 7.0) * t + 1.0);
  }
  return 0.0;
}

/// Returns the t at which |psi'| is largest. |psi'| rises up to there and falls from there on.
constexpr double wendland_steepest_at(Wendland kernel) noexcept {
  switch (kernel) {
  case Wendland::c0:
    return 0.0;
  case Wendland::c2:
    return 0.25;
  case Wendland::c4:
    return 0.23557137138281137; // 35 t^2 - 4 t - 1 = 0
  case Wendland::c6:
    return 0.21528603787469894; // 160 t^3 + 15 t^2 - 6 t - 1 = 0
  }
  return 0.0;
}

/// Returns the name, for example "wendland-c2".
NENDO_API std::string_view name_of(Wendland kernel) noexcept;
NENDO_API std::optional<Wendland> wendland_named(std::string_view name) noexcept;

} // namespace nendo::deform
