#pragma once
// The grid of a picture's or a map's samples, and which of them a triangle covers. Places are
// rounded to whole numbers once, so that all that follows is the same on any machine, and two
// triangles with a common edge leave no gap and share no sample.

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstddef>
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

/// A sample on an edge belongs to one of its two triangles.
inline bool owns_edge(std::int64_t dx, std::int64_t dy) noexcept {
  return dy < 0 || (dy == 0 && dx > 0);
}

/// Calls visit(x, y, b) for the sample if the triangle covers it. It is for triangles of about a
/// sample. No processor can predict which of them cover one, so there is but one branch for most.
template <class Visit>
void visit_if_covered(const std::array<GridCorner, 3>& on, int column, int row, Visit&& visit) {
  const auto x = [&](std::size_t k) { return std::int64_t{on[k].x} - (256 * column + 128); };
  const auto y = [&](std::size_t k) { return std::int64_t{on[k].y} - (256 * row + 128); };
  std::array<std::int64_t, 3> edge{x(1) * y(2) - x(2) * y(1), x(2) * y(0) - x(0) * y(2),
                                   x(0) * y(1) - x(1) * y(0)};
  const std::int64_t sign = edge[0] + edge[1] + edge[2] < 0 ? -1 : 1;
  const std::int64_t area = sign * (edge[0] + edge[1] + edge[2]);
  for (std::int64_t& part : edge)
    part *= sign;
  if ((edge[0] | edge[1] | edge[2]) < 0) return;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t from = (k + 1) % 3;
    const std::size_t to = (k + 2) % 3;
    if (edge[k] == 0 &&
        (area == 0 || !owns_edge(sign * (x(to) - x(from)), sign * (y(to) - y(from)))))
      return;
  }
  std::array<double, 3> b{};
  for (std::size_t k = 0; k < 3; ++k)
    b[k] = static_cast<double>(edge[k]) / static_cast<double>(area);
  visit(column, row, b);
}

/// Calls visit(x, y, b) for each sample in `box` that the triangle covers. b are the barycentric
/// coordinates of the sample. The triangle may show either side.
template <class Visit>
void each_covered(const std::array<GridCorner, 3>& on, const SampleBox& box, Visit&& visit) {
  if (box.is_empty()) return;
  if (box.x0 == box.x1 && box.y0 == box.y1) return visit_if_covered(on, box.x0, box.y0, visit);
  const auto x = [&](std::size_t k) { return std::int64_t{on[k].x}; };
  const auto y = [&](std::size_t k) { return std::int64_t{on[k].y}; };
  std::int64_t area = (x(1) - x(0)) * (y(2) - y(0)) - (x(2) - x(0)) * (y(1) - y(0));
  if (area == 0) return;
  const std::int64_t sign = area > 0 ? 1 : -1;
  area *= sign;
  std::array<std::int64_t, 3> dx{};
  std::array<std::int64_t, 3> dy{};
  std::array<std::int64_t, 3> bias{};
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t a = (k + 1) % 3;
    const std::size_t b = (k + 2) % 3;
    dx[k] = sign * (x(b) - x(a));
    dy[k] = sign * (y(b) - y(a));
    bias[k] = owns_edge(dx[k], dy[k]) ? 0 : -1;
  }
  for (int row = box.y0; row <= box.y1; ++row) {
    std::array<std::int64_t, 3> edge{}; // twice the area to each side of the sample, less the bias
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t from = (k + 1) % 3;
      edge[k] = dx[k] * (std::int64_t{row} * 256 + 128 - y(from)) -
                dy[k] * (std::int64_t{box.x0} * 256 + 128 - x(from)) + bias[k];
    }
    for (int column = box.x0; column <= box.x1; ++column) {
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
