#pragma once
// The median and percentiles of measurements.

#include <algorithm>
#include <cstddef>
#include <vector>

namespace nendo::bench {

/// Returns the value at this fraction of the sorted values, rounded down; 0 without values.
template <class Number>
double percentile(std::vector<Number> values, double fraction) {
  if (values.empty()) return 0.0;
  const auto at = static_cast<std::ptrdiff_t>(fraction * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), values.begin() + at, values.end());
  return static_cast<double>(values[static_cast<std::size_t>(at)]);
}

/// Returns the median, or of an even number of values the upper one; 0 without values.
inline double median(std::vector<double> values) {
  if (values.empty()) return 0.0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

} // namespace nendo::bench
