#pragma once
// A rim in space, closed by triangles of the least area.

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "geometry/space.hpp"

namespace nendo::deform {

/// The most corners of a rim that min_area_lid() closes: its time grows with their cube.
inline constexpr std::size_t max_crooked_rim = 600;

/// Returns triangles of the rim's corners, in its direction, whose areas have the least sum (G.
/// Barequet and M. Sharir, Filling gaps in the boundary of a polyhedron, 1995); none if there is no
/// way. `may_join(a, b)` tells whether an inner edge may go from one corner to another. Allocates.
template <class MayJoin>
std::vector<Corners> min_area_lid(std::span<const SpacePoint> rim, const MayJoin& may_join) {
  constexpr double never = 1e300;
  const std::size_t count = rim.size();
  if (count < 3 || count > max_crooked_rim) return {};
  std::vector<double> area(count * count, 0.0);
  std::vector<std::uint32_t> apex(count * count, 0);
  for (std::size_t span = 2; span < count; ++span)
    for (std::size_t from = 0; from + span < count; ++from) {
      const std::size_t to = from + span;
      double least = never;
      const bool is_inner = !(from == 0 && to + 1 == count);
      if (!is_inner || may_join(from, to))
        for (std::size_t at = from + 1; at < to; ++at) {
          const double sum = area[from * count + at] + area[at * count + to] +
                             length_of(cross(rim[at] - rim[from], rim[to] - rim[from]));
          if (!(sum < least)) continue;
          least = sum;
          apex[from * count + to] = static_cast<std::uint32_t>(at);
        }
      area[from * count + to] = least;
    }
  if (!(area[count - 1] < never)) return {};
  std::vector<Corners> lid;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> open{
      {0, static_cast<std::uint32_t>(count - 1)}};
  while (!open.empty()) {
    const auto [from, to] = open.back();
    open.pop_back();
    if (to - from < 2) continue;
    const std::uint32_t at = apex[from * count + to];
    lid.push_back({from, at, to});
    open.emplace_back(from, at);
    open.emplace_back(at, to);
  }
  return lid;
}

} // namespace nendo::deform
