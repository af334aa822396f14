#pragma once
// Finds the samples that a triangle covers. It computes in whole numbers, so that two triangles
// with a common edge leave no gap and share no sample, on any machine.

#include <array>
#include <cstddef>
#include <cstdint>

#include "render/sample_grid.hpp"

namespace nendo::render {

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
