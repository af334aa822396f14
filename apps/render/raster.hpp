#pragma once
// Finds the samples that a triangle covers. It computes in whole numbers, so that two triangles
// with a common edge leave no gap and share no sample, on any machine.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

namespace nendo::render {

/// A corner on the grid of samples. The middles of samples are at halves.
struct RasterCorner {
  double x = 0.0;
  double y = 0.0;
};

struct Rows {
  int first = 0;
  int end = 0; ///< one after the last
};

inline constexpr double farthest_sample = 1 << 20; ///< triangles with a corner beyond are left out

/// Calls visit(x, y, b) for each covered sample in `rows` of a grid that is `width` wide. b are the
/// barycentric coordinates of the sample. The triangle may show either side.
template <class Visit>
void each_covered(const std::array<RasterCorner, 3>& corners, int width, Rows rows, Visit&& visit) {
  constexpr double fraction = 256.0;
  std::array<std::int64_t, 3> x{};
  std::array<std::int64_t, 3> y{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (!(std::abs(corners[k].x) < farthest_sample && std::abs(corners[k].y) < farthest_sample))
      return;
    x[k] = static_cast<std::int64_t>(std::floor(corners[k].x * fraction + 0.5));
    y[k] = static_cast<std::int64_t>(std::floor(corners[k].y * fraction + 0.5));
  }
  std::int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
  if (area == 0) return;
  const std::int64_t sign = area > 0 ? 1 : -1;
  area *= sign;
  const auto lowest = [](const auto& v) { return std::min({v[0], v[1], v[2]}); };
  const auto highest = [](const auto& v) { return std::max({v[0], v[1], v[2]}); };
  const auto x0 = static_cast<int>(std::max<std::int64_t>(0, (lowest(x) + 127) >> 8));
  const auto x1 = static_cast<int>(std::min<std::int64_t>(width - 1, (highest(x) - 128) >> 8));
  const auto y0 = static_cast<int>(std::max<std::int64_t>(rows.first, (lowest(y) + 127) >> 8));
  const auto y1 = static_cast<int>(std::min<std::int64_t>(rows.end - 1, (highest(y) - 128) >> 8));
  std::array<std::int64_t, 3> dx{};
  std::array<std::int64_t, 3> dy{};
  std::array<std::int64_t, 3> bias{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = (k + 1) % 3;
    const std::size_t b = (k + 2) % 3;
    dx[k] = sign * (x[b] - x[a]);
    dy[k] = sign * (y[b] - y[a]);
    // A sample on an edge belongs to one of its two triangles.
    bias[k] = dy[k] < 0 || (dy[k] == 0 && dx[k] > 0) ? 0 : -1;
  }
  for (int row = y0; row <= y1; ++row) {
    std::array<std::int64_t, 3> edge{}; // twice the area to each side of the sample, less the bias
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t from = (k + 1) % 3;
      edge[k] = dx[k] * (std::int64_t{row} * 256 + 128 - y[from]) -
                dy[k] * (std::int64_t{x0} * 256 + 128 - x[from]) + bias[k];
    }
    for (int column = x0; column <= x1; ++column) {
      if ((edge[0] | edge[1] | edge[2]) >= 0) {
        std::array<double, 3> b{};
        for (std::size_t k = 0; k < 3; ++k)
          b[k] = static_cast<double>(edge[k] - bias[k]) / static_cast<double>(area);
        visit(column, row, b);
      }
      for (std::size_t k = 0; k < 3; ++k)
        edge[k] -= dy[k] * 256;
    }
  }
}

} // namespace nendo::render
