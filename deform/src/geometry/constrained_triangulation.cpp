#include "geometry/constrained_triangulation.hpp"

#include <algorithm>
#include <cassert>
#include <limits>

#include <nendo/deform/index.hpp>

namespace nendo::deform {

ConstrainedTriangulation::ConstrainedTriangulation(const PlanePoint& lowest,
                                                   const PlanePoint& highest) {
  const double span = std::max({highest[0] - lowest[0], highest[1] - lowest[1], 1e-60});
  const double far = 50.0 * span;
  const double x = lowest[0] / 2.0 + highest[0] / 2.0;
  const double y = lowest[1] / 2.0 + highest[1] / 2.0;
  points_ = {{x - far, y - far}, {x + far, y - far}, {x, y + far}};
  corners_ = {0, 1, 2};
  twins_ = {no_index, no_index, no_index};
  fixed_ = {0, 0, 0};
  edge_from_ = {0, 1, 2};
}

void ConstrainedTriangulation::reserve(std::size_t points) {
  points_.reserve(points + 3);
  edge_from_.reserve(points + 3);
  corners_.reserve(6 * points + 3);
  twins_.reserve(6 * points + 3);
  fixed_.reserve(6 * points + 3);
}

int ConstrainedTriangulation::side(std::uint32_t from, std::uint32_t to,
                                   std::uint32_t point) const noexcept {
  return orient_2d(points_[from], points_[to], points_[point]);
}

/// The two triangles beside the edge form a strictly convex quadrilateral.
bool ConstrainedTriangulation::is_convex(std::uint32_t edge) const noexcept {
  const std::uint32_t twin = twins_[edge];
  const std::uint32_t one = corners_[last(edge)];
  const std::uint32_t other = corners_[last(twin)];
  return side(one, corners_[edge], other) > 0 && side(other, corners_[twin], one) > 0;
}

bool ConstrainedTriangulation::should_flip(std::uint32_t edge) const noexcept {
  const std::uint32_t twin = twins_[edge];
  if (twin == no_index || fixed_[edge] != 0) return false;
  const std::uint32_t other = corners_[last(twin)];
  return in_circle(points_[corners_[edge]], points_[corners_[next(edge)]],
                   points_[corners_[last(edge)]], points_[other]) > 0 &&
         is_convex(edge);
}

void ConstrainedTriangulation::set(std::uint32_t edge, std::uint32_t corner, std::uint32_t twin,
                                   bool fixed) noexcept {
  corners_[edge] = corner;
  twins_[edge] = twin;
  if (twin != no_index) twins_[twin] = edge;
  fixed_[edge] = fixed ? 1 : 0;
  edge_from_[corner] = edge;
}

/// Edge p to q, with r and s beyond its sides, becomes the edge between s and r. Of the triangle
/// that had it, (p, s, r) is made, of the other one (q, r, s).
void ConstrainedTriangulation::flip(std::uint32_t edge) noexcept {
  const std::uint32_t twin = twins_[edge];
  const std::uint32_t q_r = next(edge), r_p = last(edge), p_s = next(twin), s_q = last(twin);
  const std::uint32_t p = corners_[edge], q = corners_[twin], r = corners_[r_p], s = corners_[s_q];
  const std::array twins{twins_[q_r], twins_[r_p], twins_[p_s], twins_[s_q]};
  const std::array fixed{fixed_[q_r] != 0, fixed_[r_p] != 0, fixed_[p_s] != 0, fixed_[s_q] != 0};
  const std::uint32_t one = edge - edge % 3;
  const std::uint32_t other = twin - twin % 3;
  set(one, p, twins[2], fixed[2]);
  set(one + 2, r, twins[1], fixed[1]);
  set(other, q, twins[0], fixed[0]);
  set(other + 2, s, twins[3], fixed[3]);
  set(one + 1, s, other + 1, false);
  set(other + 1, r, one + 1, false);
}

/// A triangle's first edge, and how the point lies in it: inside, or on `edge`.
struct ConstrainedTriangulation::Place {
  PlaneFault fault = PlaneFault::none;
  std::uint32_t triangle = no_index;
  std::uint32_t edge = no_index;
};

ConstrainedTriangulation::Place
ConstrainedTriangulation::locate(const PlanePoint& point) const noexcept {
  std::uint32_t triangle = start_ - start_ % 3;
  // In a triangulation that is not Delaunay a straight search may run in a circle. Beginning with
  // another edge in each triangle breaks it; the limit is for the case that it does not.
  for (std::size_t step = 0; step < 4 * corners_.size() + 16; ++step) {
    Place place{PlaneFault::none, triangle, no_index};
    std::uint32_t beyond = triangle;
    bool leaves = false;
    for (std::uint32_t k = 0; k < 3 && !leaves; ++k) {
      const std::uint32_t edge = triangle + static_cast<std::uint32_t>((k + step) % 3);
      const int turn = orient_2d(points_[corners_[edge]], points_[corners_[next(edge)]], point);
      if (turn < 0) {
        leaves = true;
        beyond = twins_[edge];
      } else if (turn == 0) {
        if (place.edge != no_index) place.fault = PlaneFault::same_point;
        place.edge = edge;
      }
    }
    if (!leaves) return place;
    if (beyond == no_index) return {PlaneFault::outside, no_index, no_index};
    triangle = beyond - beyond % 3;
  }
  return {PlaneFault::outside, no_index, no_index};
}

PlaneFault ConstrainedTriangulation::add(const PlanePoint& point) {
  const Place place = locate(point);
  if (place.fault != PlaneFault::none) return place.fault;
  if (place.edge != no_index && fixed_[place.edge] != 0) return PlaneFault::on_segment;
  if (place.edge != no_index && twins_[place.edge] == no_index) return PlaneFault::outside;
  const auto number = to_index(points_.size());
  points_.push_back(point);
  edge_from_.push_back(no_index);
  if (place.edge == no_index)
    split_triangle(place.triangle, number);
  else
    split_edge(place.edge, number);
  legalise();
  start_ = edge_from_[number];
  return PlaneFault::none;
}

/// Makes a triangle of the point and of each edge around it, and puts these edges on the stack. The
/// triangles, each by its first edge, are those around the point before and two more.
template <std::size_t count>
void ConstrainedTriangulation::surround(std::uint32_t point,
                                        const std::array<std::uint32_t, count>& around,
                                        const std::array<std::uint32_t, count>& made) {
  std::array<std::uint32_t, count> corners{}, twins{};
  std::array<bool, count> fixed{};
  for (std::size_t k = 0; k < count; ++k) {
    corners[k] = corners_[around[k]];
    twins[k] = twins_[around[k]];
    fixed[k] = fixed_[around[k]] != 0;
  }
  corners_.resize(corners_.size() + 6);
  twins_.resize(corners_.size());
  fixed_.resize(corners_.size());
  for (std::size_t k = 0; k < count; ++k) {
    const std::size_t next = (k + 1) % count;
    set(made[k], point, made[(k + count - 1) % count] + 2, false);
    set(made[k] + 1, corners[k], twins[k], fixed[k]);
    set(made[k] + 2, corners[next], made[next], false);
    stack_.push_back(made[k] + 1);
  }
}

void ConstrainedTriangulation::split_triangle(std::uint32_t triangle, std::uint32_t point) {
  const auto more = to_index(corners_.size());
  surround<3>(point, {triangle, triangle + 1, triangle + 2}, {triangle, more, more + 3});
}

void ConstrainedTriangulation::split_edge(std::uint32_t edge, std::uint32_t point) {
  const auto more = to_index(corners_.size());
  const std::uint32_t twin = twins_[edge];
  surround<4>(point, {next(edge), last(edge), next(twin), last(twin)},
              {edge - edge % 3, more, twin - twin % 3, more + 3});
}

/// Flips the edges on the stack, and those beyond them, as far as Delaunay asks for it. The corner
/// opposite to each is the new point.
void ConstrainedTriangulation::legalise() {
  while (!stack_.empty()) {
    const std::uint32_t edge = stack_.back();
    stack_.pop_back();
    if (!should_flip(edge)) continue;
    const std::uint32_t other = twins_[edge];
    flip(edge);
    stack_.push_back(edge - edge % 3);
    stack_.push_back(other - other % 3 + 2);
  }
}

void ConstrainedTriangulation::improve() {
  for (std::uint32_t edge = 0; edge < corners_.size(); ++edge)
    if (twins_[edge] != no_index && edge < twins_[edge]) stack_.push_back(edge);
  while (!stack_.empty()) {
    const std::uint32_t edge = stack_.back();
    stack_.pop_back();
    if (!should_flip(edge)) continue;
    const std::uint32_t one = edge - edge % 3;
    const std::uint32_t other = twins_[edge] - twins_[edge] % 3;
    flip(edge);
    stack_.insert(stack_.end(), {one, one + 2, other, other + 2});
  }
}

/// Returns the edge from one point to another, or no_index. `from` is no corner of the outer
/// triangle, so there are triangles all round it.
std::uint32_t ConstrainedTriangulation::edge_between(std::uint32_t from,
                                                     std::uint32_t to) const noexcept {
  const std::uint32_t first = edge_from_[from];
  std::uint32_t edge = first;
  do {
    if (corners_[next(edge)] == to) return edge;
    edge = twins_[last(edge)];
  } while (edge != first);
  return no_index;
}

PlaneFault ConstrainedTriangulation::constrain(std::uint32_t from, std::uint32_t to) {
  assert(from != to && from < point_count() && to < point_count());
  from += 3;
  to += 3;
  std::uint32_t edge = edge_between(from, to);
  if (edge == no_index) {
    if (const PlaneFault fault = collect_crossed(from, to); fault != PlaneFault::none) return fault;
    flip_crossed(from, to);
    edge = edge_between(from, to);
    assert(edge != no_index);
  }
  fixed_[edge] = 1;
  fixed_[twins_[edge]] = 1;
  return PlaneFault::none;
}

/// Lists the edges between the two points, in order.
PlaneFault ConstrainedTriangulation::collect_crossed(std::uint32_t from, std::uint32_t to) {
  crossed_.clear();
  const auto is_ahead = [&](std::uint32_t point) {
    const PlanePoint& a = points_[from];
    const PlanePoint& b = points_[to];
    const PlanePoint& c = points_[point];
    return (c[0] - a[0]) * (b[0] - a[0]) + (c[1] - a[1]) * (b[1] - a[1]) > 0.0;
  };
  std::uint32_t leaving = no_index;
  const std::uint32_t first = edge_from_[from];
  std::uint32_t edge = first;
  do {
    const std::uint32_t right = corners_[next(edge)];
    const int right_turn = side(from, to, right);
    if (right_turn == 0 && is_ahead(right)) return PlaneFault::on_point;
    if (right_turn < 0 && side(from, to, corners_[last(edge)]) > 0) leaving = next(edge);
    edge = twins_[last(edge)];
  } while (edge != first && leaving == no_index);
  while (leaving != no_index) {
    if (fixed_[leaving] != 0) return PlaneFault::crossing;
    crossed_.push_back({corners_[leaving], corners_[next(leaving)]});
    const std::uint32_t twin = twins_[leaving];
    const std::uint32_t beyond = corners_[last(twin)];
    if (beyond == to) return PlaneFault::none;
    const int turn = side(from, to, beyond);
    if (turn == 0) return PlaneFault::on_point;
    // The twin goes from the left end to the right one. What comes after it begins at the right
    // end.
    leaving = turn < 0 ? last(twin) : next(twin);
  }
  return PlaneFault::crossing;
}

/// Flips the edges of the list, each as soon as its neighbours allow it, until none crosses.
void ConstrainedTriangulation::flip_crossed(std::uint32_t from, std::uint32_t to) {
  for (std::size_t at = 0; at < crossed_.size(); ++at) {
    const auto [right, left] = crossed_[at];
    const std::uint32_t edge =
        right >= 3 ? edge_between(right, left) : twins_[edge_between(left, right)];
    if (!is_convex(edge)) {
      crossed_.push_back(crossed_[at]);
    } else {
      const std::uint32_t one = corners_[last(edge)];
      const std::uint32_t other = corners_[last(twins_[edge])];
      flip(edge);
      if (one == from || one == to || other == from || other == to) continue;
      const int turn = side(from, to, one);
      if (turn == side(from, to, other)) continue;
      if (turn < 0)
        crossed_.push_back({one, other});
      else
        crossed_.push_back({other, one});
    }
    // What was looked at is dropped now and then, so that the list stays short.
    if (at > 1024 && at * 2 > crossed_.size()) {
      crossed_.erase(crossed_.begin(), crossed_.begin() + static_cast<std::ptrdiff_t>(at + 1));
      at = std::numeric_limits<std::size_t>::max();
    }
  }
}

/// Of each triangle the least number of segments between it and the outermost one.
std::vector<std::uint32_t> ConstrainedTriangulation::segments_from_outside() const {
  std::vector<std::uint32_t> depth(corners_.size() / 3, no_index);
  std::vector<std::uint32_t> here{edge_from_[0] / 3};
  std::vector<std::uint32_t> deeper;
  depth[here.front()] = 0;
  for (std::uint32_t level = 0; !here.empty(); ++level) {
    while (!here.empty()) {
      const std::uint32_t triangle = here.back();
      here.pop_back();
      if (depth[triangle] != level) continue;
      for (std::uint32_t edge = 3 * triangle; edge < 3 * triangle + 3; ++edge) {
        if (twins_[edge] == no_index) continue;
        const std::uint32_t beyond = twins_[edge] / 3;
        if (depth[beyond] != no_index && depth[beyond] <= level) continue;
        const bool parted = fixed_[edge] != 0;
        if (parted && depth[beyond] != no_index) continue;
        depth[beyond] = parted ? level + 1 : level;
        (parted ? deeper : here).push_back(beyond);
      }
    }
    here.swap(deeper);
  }
  return depth;
}

std::vector<ConstrainedTriangulation::Triangle>
ConstrainedTriangulation::triangles(PlaneFill fill) const {
  const std::vector<std::uint32_t> depth = segments_from_outside();
  std::vector<Triangle> chosen;
  for (std::uint32_t triangle = 0; triangle < depth.size(); ++triangle) {
    const bool is_in = fill == PlaneFill::enclosed ? depth[triangle] > 0 : depth[triangle] % 2 == 1;
    if (!is_in) continue;
    const std::size_t first = std::size_t{3} * triangle;
    const Triangle corners{corners_[first], corners_[first + 1], corners_[first + 2]};
    if (std::any_of(corners.begin(), corners.end(), [](std::uint32_t c) { return c < 3; }))
      continue;
    chosen.push_back({corners[0] - 3, corners[1] - 3, corners[2] - 3});
  }
  return chosen;
}

} // namespace nendo::deform
