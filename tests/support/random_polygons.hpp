#pragma once
// Polygons of every kind that files have as one face: counter-clockwise, with whole numbers as
// coordinates, so that tests can judge them exactly.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <random>
#include <vector>

namespace nendo::test {

using GridPoint = std::array<std::int64_t, 2>;

/// Corners by numbers of points: a corner of a bridge has the number of a corner before.
struct GridPolygon {
  std::vector<GridPoint> points;
  std::vector<std::uint32_t> corners;
};

/// > 0 if a, b, c turn to the left.
inline std::int64_t grid_turn(const GridPoint& a, const GridPoint& b, const GridPoint& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

/// Twice the area.
inline std::int64_t grid_area(const GridPolygon& polygon) {
  std::int64_t sum = 0;
  for (std::size_t at = 2; at < polygon.corners.size(); ++at)
    sum += grid_turn(polygon.points[polygon.corners[0]], polygon.points[polygon.corners[at - 1]],
                     polygon.points[polygon.corners[at]]);
  return sum;
}

inline GridPolygon polygon_of(std::vector<GridPoint> points) {
  GridPolygon polygon{std::move(points), {}};
  for (std::uint32_t at = 0; at < polygon.points.size(); ++at)
    polygon.corners.push_back(at);
  return polygon;
}

/// Seen whole from its middle, and as a rule from no corner.
inline GridPolygon star_polygon(std::mt19937& random, int corners) {
  std::uniform_int_distribution<std::int64_t> radius(100, 1000);
  std::vector<GridPoint> points;
  for (int at = 0; at < corners; ++at) {
    const double turn = 2.0 * std::numbers::pi * at / corners;
    const auto r = static_cast<double>(radius(random));
    points.push_back({std::llround(r * std::cos(turn)), std::llround(r * std::sin(turn))});
  }
  return polygon_of(std::move(points));
}

/// A band that is wound around its own beginning.
inline GridPolygon spiral_polygon(int corners, double turns) {
  std::vector<GridPoint> points;
  const int half = corners / 2;
  const auto put = [&](int at, double more) {
    const double turn = 2.0 * std::numbers::pi * turns * at / (half - 1);
    const double r = 200.0 + 400.0 * turn / (2.0 * std::numbers::pi) + more;
    points.push_back({std::llround(r * std::cos(turn)), std::llround(r * std::sin(turn))});
  };
  for (int at = 0; at < half; ++at)
    put(at, 150.0);
  for (int at = half; at-- > 0;)
    put(at, 0.0);
  return polygon_of(std::move(points));
}

inline GridPolygon comb_polygon(std::mt19937& random, int teeth) {
  std::uniform_int_distribution<std::int64_t> depth(10, 990);
  std::vector<GridPoint> points{{0, 0}, {20 * teeth, 0}};
  for (int tooth = teeth; tooth-- > 0;) {
    points.push_back({20 * tooth + 20, 1000});
    points.push_back({20 * tooth + 10, 1000});
    points.push_back({20 * tooth + 10, 1000 - depth(random)});
    if (tooth > 0) points.push_back({20 * tooth, points.back()[1]});
  }
  points.push_back({0, points.back()[1]});
  return polygon_of(std::move(points));
}

/// Whether segments have a point in common; one that both have as an end does not count.
inline bool grid_segments_meet(const GridPoint& p, const GridPoint& q, const GridPoint& a,
                               const GridPoint& b) {
  const auto sign = [](std::int64_t value) { return value > 0 ? 1 : value < 0 ? -1 : 0; };
  const auto is_on = [&](const GridPoint& x, const GridPoint& from, const GridPoint& to) {
    return grid_turn(from, to, x) == 0 && x != from && x != to &&
           std::min(from[0], to[0]) <= x[0] && x[0] <= std::max(from[0], to[0]) &&
           std::min(from[1], to[1]) <= x[1] && x[1] <= std::max(from[1], to[1]);
  };
  if (is_on(p, a, b) || is_on(q, a, b) || is_on(a, p, q) || is_on(b, p, q)) return true;
  return sign(grid_turn(p, q, a)) * sign(grid_turn(p, q, b)) < 0 &&
         sign(grid_turn(a, b, p)) * sign(grid_turn(a, b, q)) < 0;
}

/// Corners anywhere: two edges that cross are turned round until none are.
inline GridPolygon tangled_polygon(std::mt19937& random, int corners) {
  std::uniform_int_distribution<std::int64_t> place(0, 1000);
  for (;;) {
    std::vector<GridPoint> points(static_cast<std::size_t>(corners));
    for (GridPoint& point : points)
      point = {place(random), place(random)};
    bool crosses = true;
    for (int round = 0; round < 1000 && crosses; ++round) {
      crosses = false;
      for (std::size_t one = 0; one < points.size() && !crosses; ++one)
        for (std::size_t other = one + 1; other < points.size() && !crosses; ++other) {
          crosses = grid_segments_meet(points[one], points[(one + 1) % points.size()],
                                       points[other], points[(other + 1) % points.size()]);
          if (crosses)
            std::reverse(points.begin() + static_cast<std::ptrdiff_t>(one) + 1,
                         points.begin() + static_cast<std::ptrdiff_t>(other) + 1);
        }
    }
    GridPolygon polygon = polygon_of(points);
    if (crosses || grid_area(polygon) == 0) continue;
    if (grid_area(polygon) < 0) std::reverse(polygon.points.begin(), polygon.points.end());
    return polygon;
  }
}

/// The outline of squares that hang together, with a corner at every step: many lie in line. Where
/// squares touch at a corner around something empty, the outline goes through it twice.
inline GridPolygon step_polygon(std::mt19937& random, int squares) {
  constexpr int side = 16;
  std::array<std::array<bool, side + 2>, side + 2> full{};
  full[side / 2][side / 2] = true;
  std::uniform_int_distribution<int> place(2, side - 1);
  const auto is_outside_whole = [&] { // all that is empty hangs together, if only by corners
    auto seen = full;
    std::vector<std::array<int, 2>> due{{0, 0}};
    seen[0][0] = true;
    while (!due.empty()) {
      const auto [x, y] = due.back();
      due.pop_back();
      for (int u = std::max(x - 1, 0); u <= std::min(x + 1, side + 1); ++u)
        for (int v = std::max(y - 1, 0); v <= std::min(y + 1, side + 1); ++v) {
          bool& cell = seen[static_cast<std::size_t>(u)][static_cast<std::size_t>(v)];
          if (!cell) due.push_back({u, v});
          cell = true;
        }
    }
    return std::all_of(seen.begin(), seen.end(), [](const auto& row) {
      return std::all_of(row.begin(), row.end(), [](bool cell) { return cell; });
    });
  };
  const auto at = [&](int x, int y) -> bool& {
    return full[static_cast<std::size_t>(x)][static_cast<std::size_t>(y)];
  };
  for (int count = 1, tries = 0; count < squares && tries < 4000; ++tries) {
    const int x = place(random), y = place(random);
    if (at(x, y) || !(at(x - 1, y) || at(x + 1, y) || at(x, y - 1) || at(x, y + 1))) continue;
    at(x, y) = true;
    if (is_outside_whole())
      ++count;
    else
      at(x, y) = false;
  }
  // Along the squares, which are on the left.
  const auto is_edge = [&](int x, int y, int dx, int dy) {
    const auto square = [&](int to_x, int to_y) {
      return at(x - (to_x > 0 ? 0 : 1), y - (to_y > 0 ? 0 : 1));
    };
    const bool left = dx != 0 ? square(dx, dx) : square(-dy, dy);
    const bool right = dx != 0 ? square(dx, -dx) : square(dy, dy);
    return left && !right;
  };
  int x = 1, y = 1; // the lowest edge to the right, and of these the first
  while (!is_edge(x, y, 1, 0))
    if (++x > side) {
      x = 1;
      ++y;
    }
  GridPolygon polygon;
  std::vector<std::array<int, 2>> places;
  const int first_x = x, first_y = y;
  int dx = 1, dy = 0;
  do {
    const auto known = std::find(places.begin(), places.end(), std::array{x, y});
    polygon.corners.push_back(static_cast<std::uint32_t>(known - places.begin()));
    if (known == places.end()) {
      places.push_back({x, y});
      polygon.points.push_back({100 * x, 100 * y});
    }
    x += dx;
    y += dy;
    const std::array<std::array<int, 2>, 3> ways{{{-dy, dx}, {dx, dy}, {dy, -dx}}};
    for (const auto& [to_x, to_y] : ways)
      if (is_edge(x, y, to_x, to_y)) {
        dx = to_x;
        dy = to_y;
        break;
      }
  } while (x != first_x || y != first_y || dx != 1 || dy != 0);
  return polygon;
}

/// Joins a hole, which runs clockwise, to a polygon by a bridge: its two corners are corners twice.
/// Returns false if no straight bridge is free.
inline bool add_hole(GridPolygon& polygon, const std::vector<GridPoint>& hole) {
  const auto crosses = [&](const GridPoint& from, const GridPoint& to) {
    const std::size_t count = polygon.corners.size();
    for (std::size_t at = 0; at < count; ++at)
      if (grid_segments_meet(from, to, polygon.points[polygon.corners[at]],
                             polygon.points[polygon.corners[(at + 1) % count]]))
        return true;
    for (std::size_t at = 0; at < hole.size(); ++at)
      if (grid_segments_meet(from, to, hole[at], hole[(at + 1) % hole.size()])) return true;
    return false;
  };
  for (std::size_t at = 0; at < polygon.corners.size(); ++at) {
    // The way of the bridge must lead inwards.
    const std::size_t count = polygon.corners.size();
    const GridPoint& here = polygon.points[polygon.corners[at]];
    const GridPoint& before = polygon.points[polygon.corners[(at + count - 1) % count]];
    const GridPoint& behind = polygon.points[polygon.corners[(at + 1) % count]];
    for (std::size_t first = 0; first < hole.size(); ++first) {
      const GridPoint& to = hole[first];
      const bool left = grid_turn(here, behind, to) > 0, right = grid_turn(before, here, to) > 0;
      const bool is_in = grid_turn(before, here, behind) > 0 ? left && right : left || right;
      if (!is_in || crosses(here, to)) continue;
      const auto number = static_cast<std::uint32_t>(polygon.points.size());
      std::vector<std::uint32_t> way;
      for (std::size_t k = 0; k <= hole.size(); ++k)
        way.push_back(number + static_cast<std::uint32_t>((first + k) % hole.size()));
      way.push_back(polygon.corners[at]);
      polygon.points.insert(polygon.points.end(), hole.begin(), hole.end());
      polygon.corners.insert(polygon.corners.begin() + static_cast<std::ptrdiff_t>(at) + 1,
                             way.begin(), way.end());
      return true;
    }
  }
  return false;
}

/// A square with holes in rows, each joined by a bridge.
inline GridPolygon polygon_with_holes(std::mt19937& random, int holes) {
  GridPolygon polygon = polygon_of({{0, 0}, {4000, 0}, {4000, 4000}, {0, 4000}});
  std::uniform_int_distribution<int> corners(3, 7);
  for (int hole = 0; hole < holes; ++hole) {
    GridPolygon star = star_polygon(random, corners(random));
    for (GridPoint& point : star.points)
      point = {point[0] * 3 / 8 + 500 + 1000 * (hole % 4),
               point[1] * 3 / 8 + 500 + 1000 * (hole / 4)};
    std::reverse(star.points.begin(), star.points.end());
    add_hole(polygon, star.points);
  }
  return polygon;
}

} // namespace nendo::test
