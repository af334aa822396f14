#pragma once
// Computes the sines and cosines of many angles at once. A pose needs two dozen of them. Those of
// the standard library would take most of its time: they are computed one by one and are exact to
// the last bit, which is not visible in a hand. These use the vector unit and are right to 2e-15.

#include <array>
#include <cmath>
#include <numbers>

#include <Eigen/Core>

#include <nendo/base/units.hpp>

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

// The constant rotations of the hand's shape, which forward and inverse kinematics share.
// At zero angles the thumb lies beside the index finger. Its bones diverge from it by the width of
// the web, and its nail is turned towards the thumb's side, so that its flexion runs across the
// palm and not towards it.
inline constexpr double thumb_rest_abduction_rad = from_degrees(15);

// The thumb's carpometacarpal joint is a saddle. Its axes of flexion and abduction are those of the
// trapezium, 48 degrees flexed, 38 abducted and 80 pronated to the third metacarpal (W. P. Cooney,
// M. J. Lucca, E. Y. S. Chao, R. L. Linscheid, "The kinesiology of the thumb trapeziometacarpal
// joint", J. Bone Joint Surg. 63-A, 1981, 1371-1381), where the first axis is fixed in the
// trapezium and the second in the metacarpal (A. Hollister et al., "The axes of rotation of the
// thumb carpometacarpal joint", J. Orthop. Res. 10, 1992, 454-460). A glove's angles say where
// such a thumb points: roll carries it round the index metacarpal, abduction away from that. The
// saddle determines how far the thumb is then turned about its own axis; it adds the 17 degrees of
// pronation that Cooney found over 53 of flexion. The line below approximates that to 5 degrees
// (root mean square; 14 at a corner) for roll from 0 to 90 and abduction from 0 to 50 degrees. Roll
// and abduction alone would turn the thumb much farther, and the rolled thumb would bend away from
// the fingers.
inline constexpr double thumb_pronation_rad = from_degrees(47);
inline constexpr double pronation_by_roll = -0.41;
inline constexpr double pronation_by_abduction = -0.27;

// How much of the palm's arch moves each metacarpal, from index to little finger. The little
// finger's metacarpal moves most, the ring finger's about half as much; those of index and middle
// finger are fixed to the carpus.
inline constexpr std::array<double, 4> arch_share{0.0, 0.0, 0.5, 1.0};

} // namespace nendo::hand
