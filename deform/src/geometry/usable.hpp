#pragma once
// The bound of numbers that are accepted from outside.

#include <cmath>
#include <string_view>

#include <Eigen/Core>

namespace nendo::deform {

/// No model is that large. Below this bound, squares, cubes and sums of coordinates stay finite.
inline constexpr double largest_number = 1e100;

/// Returns true if the magnitude is at most largest_number. It is false for NaN.
constexpr bool is_usable(double value) noexcept {
  return value <= largest_number && value >= -largest_number;
}

/// Why a field of a text is no usable number, to follow that field in a message.
constexpr std::string_view not_usable(std::string_view field) noexcept {
  return field.find(',') == std::string_view::npos
             ? " is not a finite number of at most 1e100"
             : " is not a finite number of at most 1e100; write decimals with a point";
}

template <class Derived>
bool all_usable(const Eigen::DenseBase<Derived>& values, double largest = largest_number) noexcept {
  // Plain loops compile in a fraction of the time of Eigen's expressions.
  for (Eigen::Index column = 0; column < values.cols(); ++column)
    for (Eigen::Index row = 0; row < values.rows(); ++row)
      if (!(std::abs(static_cast<double>(values.derived()(row, column))) <= largest)) return false;
  return true;
}

} // namespace nendo::deform
