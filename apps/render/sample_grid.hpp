#pragma once
// The grid of a picture's or a map's samples, and where triangles are on it. Places are rounded to
// whole numbers once, so that all that follows is the same on any machine.

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>

namespace nendo::render {

/// A corner in 256ths of a sample. The middles of samples are at halves of a sample.
struct GridCorner {
  std::int32_t x = 0;
  std::int32_t y = 0;
};

struct Rows {
  int first = 0;
  int end = 0; ///< one after the last
};

inline constexpr double farthest_sample = 1 << 20; ///< triangles with a corner beyond are left out
inline constexpr std::int32_t beyond_grid = 1 << 29; ///< a coordinate that is not on the grid

/// Returns a coordinate, in samples, in 256ths of a sample. It has neither branches nor calls, so
/// that loops compute several at once.
template <std::floating_point Number>
std::int32_t on_grid(Number samples) noexcept {
  const bool fits = std::abs(samples) < static_cast<Number>(farthest_sample);
  const Number scaled = (fits ? samples : Number{0}) * 256; // exact
  const auto toward_zero = static_cast<std::int32_t>(scaled);
  const std::int32_t below =
      toward_zero - (scaled < static_cast<Number>(toward_zero) ? 1 : 0); // std::floor()
  const std::int32_t nearest = below + (scaled - static_cast<Number>(below) >= Number{0.5} ? 1 : 0);
  return fits ? nearest : beyond_grid;
}

/// The samples that a triangle may cover.
struct SampleBox {
  int x0 = 0, x1 = -1, y0 = 0, y1 = -1; ///< the last ones belong to it
  bool is_empty() const noexcept { return x0 > x1 || y0 > y1; }
};

/// Returns the samples in `rows` of a grid, `width` wide, whose middles are in the triangle's box.
/// It is empty for a triangle that is not on the grid. Most triangles of a dense model are smaller
/// than a sample and have an empty box, so this is the quick test.
inline SampleBox sample_box(const std::array<GridCorner, 3>& on, int width, Rows rows) noexcept {
  const auto lowest = [](int a, int b, int c) { return std::min(std::min(a, b), c); };
  const auto highest = [](int a, int b, int c) { return std::max(std::max(a, b), c); };
  const int left = lowest(on[0].x, on[1].x, on[2].x);
  const int right = highest(on[0].x, on[1].x, on[2].x);
  const int top = lowest(on[0].y, on[1].y, on[2].y);
  const int bottom = highest(on[0].y, on[1].y, on[2].y);
  const SampleBox box{std::max(0, (left + 127) >> 8), std::min(width - 1, (right - 128) >> 8),
                      std::max(rows.first, (top + 127) >> 8),
                      std::min(rows.end - 1, (bottom - 128) >> 8)};
  if (box.is_empty() || std::max(right, bottom) == beyond_grid) return {};
  return box;
}

} // namespace nendo::render
