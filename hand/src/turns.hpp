#pragma once
// Computes the sines and cosines of many angles at once. A pose needs two dozen of them. Those of
// the standard library would take most of its time: they are computed one by one and are exact to
// the last bit, which is not visible in a hand. These use the vector unit and are right to 2e-15.

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

namespace nendo::hand {

struct Turn {
  double sin = 0.0;
  double cos = 1.0;
  constexpr Turn reversed() const noexcept { return {-sin, cos}; }
};

template <int N>
struct Turns {
  Eigen::Array<double, N, 1> sin;
  Eigen::Array<double, N, 1> cos;
  Turn operator[](Eigen::Index at) const noexcept { return {sin[at], cos[at]}; }
};

namespace detail {

// Taylor's series in the square of an eighth of the angle. The eighth is at most pi / 4, where the
// first term left out is below 1e-16.
inline constexpr std::array<double, 8> sine_terms{
    1.0,           -1.0 / 6,          1.0 / 120,           -1.0 / 5040,
    1.0 / 362'880, -1.0 / 39'916'800, 1.0 / 6'227'020'800, -1.0 / 1'307'674'368'000};
inline constexpr std::array<double, 9> cosine_terms{1.0,
                                                    -1.0 / 2,
                                                    1.0 / 24,
                                                    -1.0 / 720,
                                                    1.0 / 40'320,
                                                    -1.0 / 3'628'800,
                                                    1.0 / 479'001'600,
                                                    -1.0 / 87'178'291'200,
                                                    1.0 / 20'922'789'888'000};

template <std::size_t Terms>
Eigen::Array2d series(const std::array<double, Terms>& terms,
                      const Eigen::Array2d& square) noexcept {
  Eigen::Array2d sum = Eigen::Array2d::Constant(terms.back());
  for (std::size_t k = Terms - 1; k-- > 0;)
    sum = sum * square + terms[k];
  return sum;
}

} // namespace detail

/// Returns the sines and cosines of N angles; N must be even. An angle that is not finite counts as
/// zero. Wait-free.
template <int N>
Turns<N> turns(const Eigen::Array<double, N, 1>& angles_rad) noexcept {
  static_assert(N % 2 == 0, "angles go through the vector unit in pairs");
  Turns<N> result;
  for (Eigen::Index at = 0; at < N; at += 2) {
    const Eigen::Array2d eighth = 0.125 * angles_rad.template segment<2>(at);
    const Eigen::Array2d square = eighth * eighth;
    Eigen::Array2d sin = eighth * detail::series(detail::sine_terms, square);
    Eigen::Array2d cos = detail::series(detail::cosine_terms, square);
    for (int doubling = 0; doubling < 3; ++doubling) {
      const Eigen::Array2d sin_of_double = 2.0 * sin * cos;
      cos = 1.0 - 2.0 * sin * sin;
      sin = sin_of_double;
    }
    result.sin.template segment<2>(at) = sin;
    result.cos.template segment<2>(at) = cos;
  }
  if ((angles_rad.abs() <= 2.0 * std::numbers::pi).all()) return result;
  for (Eigen::Index at = 0; at < N; ++at) {
    if (std::abs(angles_rad[at]) <= 2.0 * std::numbers::pi) continue;
    const double angle_rad = std::isfinite(angles_rad[at]) ? angles_rad[at] : 0.0;
    result.sin[at] = std::sin(angle_rad);
    result.cos[at] = std::cos(angle_rad);
  }
  return result;
}

} // namespace nendo::hand
