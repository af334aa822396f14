#include "geometry/octree_order.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

namespace nendo::deform {
namespace {

constexpr int depth = 21;

/// Leaves two zero bits after each of the lowest 21 bits.
std::uint64_t spread_bits(std::uint64_t bits) noexcept {
  bits = (bits | bits << 32) & 0x001f00000000ffff;
  bits = (bits | bits << 16) & 0x001f0000ff0000ff;
  bits = (bits | bits << 8) & 0x100f00f00f00f00f;
  bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
  return (bits | bits << 2) & 0x1249249249249249;
}

struct Cube {
  Eigen::Vector3d lowest = Eigen::Vector3d::Zero();
  double half_edge = 0.0; ///< halves: of the largest doubles, the edge itself would overflow
};

Cube bounding_cube(const Points& points) {
  const auto [lowest, highest] = finite_box_of(points);
  return {lowest, (highest / 2.0 - lowest / 2.0).maxCoeff()};
}

std::uint64_t morton_code(const Eigen::Vector3d& point, const Cube& cube) noexcept {
  constexpr double cells = 1 << depth;
  if (!point.allFinite()) return std::numeric_limits<std::uint64_t>::max();
  std::uint64_t code = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double from_lowest = point[axis] / 2.0 - cube.lowest[axis] / 2.0;
    const double fraction = cube.half_edge > 0.0 ? from_lowest / cube.half_edge : 0.0;
    const double cell = std::clamp(std::floor(fraction * cells), 0.0, cells - 1.0);
    code |= spread_bits(static_cast<std::uint64_t>(cell)) << axis;
  }
  return code;
}

struct CodedPoint {
  std::uint64_t code;
  std::uint32_t index;
};

/// Digit by digit, the last one first, so that points of one code keep their order. A model has so
/// many triangles that comparing them takes twice as long.
void sort_by_code(std::vector<CodedPoint>& points) {
  constexpr unsigned digit_bits = 11;
  constexpr std::size_t digits = std::size_t{1} << digit_bits;
  std::vector<CodedPoint> sorted(points.size());
  for (unsigned shift = 0; shift < 64; shift += digit_bits) {
    const auto digit = [&](const CodedPoint& point) { return point.code >> shift & (digits - 1); };
    std::array<std::uint32_t, digits + 1> begins{};
    for (const CodedPoint& point : points)
      ++begins[digit(point) + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    for (const CodedPoint& point : points)
      sorted[begins[digit(point)]++] = point;
    points.swap(sorted);
  }
}

} // namespace

std::vector<std::uint32_t> octree_order(const Points& points) {
  const Cube cube = bounding_cube(points);
  std::vector<CodedPoint> codes;
  codes.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i)
    codes.push_back({morton_code(points.col(i), cube), static_cast<std::uint32_t>(i)});
  sort_by_code(codes);
  std::vector<std::uint32_t> order;
  order.reserve(codes.size());
  for (const auto& [code, index] : codes)
    order.push_back(index);
  return order;
}

} // namespace nendo::deform
