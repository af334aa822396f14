#include "join/self_intersections.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "cut/exact_predicates.hpp"
#include "join/box_tree.hpp"

namespace nendo::deform {
namespace {

/// Without the coordinate `axis`: a triangle whose normal has a positive one turns to the left.
int turn_along(std::size_t axis, const SpacePoint& a, const SpacePoint& b,
               const SpacePoint& c) noexcept {
  const std::size_t x = (axis + 1) % 3;
  const std::size_t y = (axis + 2) % 3;
  return orient_2d({a[x], a[y]}, {b[x], b[y]}, {c[x], c[y]});
}

using Triangle = std::array<const SpacePoint*, 3>;

/// An axis along which the triangle keeps its area; 3 if it has none.
std::size_t axis_with_area(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept {
  const SpacePoint normal = area_vector(a, b, c);
  std::size_t best = 0;
  for (std::size_t axis = 1; axis < 3; ++axis)
    if (std::abs(normal[axis]) > std::abs(normal[best])) best = axis;
  for (std::size_t turn = 0; turn < 3; ++turn) {
    const std::size_t axis = (best + turn) % 3;
    if (turn_along(axis, a, b, c) != 0) return axis;
  }
  return 3;
}

bool differ(int a, int b, int c) noexcept {
  return std::max({a, b, c}) > 0 && std::min({a, b, c}) < 0;
}

/// In a plane, seen along `axis`: two closed segments have a point in common.
bool segments_meet(std::size_t axis, const SpacePoint& p, const SpacePoint& q, const SpacePoint& a,
                   const SpacePoint& b) noexcept {
  const int pa = turn_along(axis, p, q, a);
  const int pb = turn_along(axis, p, q, b);
  const int ap = turn_along(axis, a, b, p);
  const int aq = turn_along(axis, a, b, q);
  if (pa * pb > 0 || ap * aq > 0) return false;
  if (pa != 0 || pb != 0 || ap != 0 || aq != 0) return true;
  for (std::size_t k = 0; k < 3; ++k) // all in one line: their boxes must meet
    if (k != axis && (std::max(p[k], q[k]) < std::min(a[k], b[k]) ||
                      std::max(a[k], b[k]) < std::min(p[k], q[k])))
      return false;
  return true;
}

/// A segment in the triangle's plane and the triangle have a point in common.
bool meets_in_plane(const SpacePoint& p, const SpacePoint& q, const Triangle& t) noexcept {
  const std::size_t axis = axis_with_area(*t[0], *t[1], *t[2]);
  if (axis == 3) return true; // on the safe side
  for (std::size_t k = 0; k < 3; ++k)
    if (segments_meet(axis, p, q, *t[k], *t[(k + 1) % 3])) return true;
  return !differ(turn_along(axis, *t[0], *t[1], p), turn_along(axis, *t[1], *t[2], p),
                 turn_along(axis, *t[2], *t[0], p));
}

/// A segment and a triangle have a point in common. The sides are those of the segment's ends.
bool segment_meets(const SpacePoint& p, const SpacePoint& q, int side_p, int side_q,
                   const Triangle& t) noexcept {
  if (side_p * side_q > 0) return false;
  if (side_p == 0 && side_q == 0) return meets_in_plane(p, q, t);
  return !differ(orient_3d(p, q, *t[0], *t[1]), orient_3d(p, q, *t[1], *t[2]),
                 orient_3d(p, q, *t[2], *t[0]));
}

bool edge_meets(const SpacePoint& p, const SpacePoint& q, const Triangle& t) noexcept {
  return segment_meets(p, q, orient_3d(*t[0], *t[1], *t[2], p), orient_3d(*t[0], *t[1], *t[2], q),
                       t);
}

/// Of two triangles without a common vertex: some edge of `one` meets `other`. `apart` becomes true
/// if all of `one` is on one side of `other`'s plane.
bool any_edge_meets(const Triangle& one, const Triangle& other, bool& apart) noexcept {
  std::array<int, 3> side{};
  for (std::size_t k = 0; k < 3; ++k)
    side[k] = orient_3d(*other[0], *other[1], *other[2], *one[k]);
  apart = side[0] != 0 && side[0] == side[1] && side[1] == side[2];
  if (apart) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    if (segment_meets(*one[k], *one[next], side[k], side[next], other)) return true;
  }
  return false;
}

bool strangers_meet(const Triangle& one, const Triangle& other) noexcept {
  bool apart = false;
  if (any_edge_meets(one, other, apart)) return true;
  return !apart && any_edge_meets(other, one, apart);
}

/// Of two triangles with the edge from one[0] to one[1] in common, and one[2] and `tip` opposite.
bool folded_onto(const Triangle& one, const SpacePoint& tip) noexcept {
  if (orient_3d(*one[0], *one[1], *one[2], tip) != 0) return false;
  const std::size_t axis = axis_with_area(*one[0], *one[1], *one[2]);
  if (axis == 3) return true;
  return turn_along(axis, *one[0], *one[1], *one[2]) == turn_along(axis, *one[0], *one[1], tip);
}

struct Shared {
  std::size_t count = 0;
  std::array<std::size_t, 3> of_one{};
  std::array<bool, 3> in_other{};
};

Shared shared_by(const Corners& one, const Corners& other) noexcept {
  Shared shared;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t m = 0; m < 3; ++m)
      if (one[k] == other[m]) {
        shared.of_one[shared.count++] = k;
        shared.in_other[m] = true;
        break;
      }
  return shared;
}

Triangle places_of(std::span<const SpacePoint> places, const Corners& corners,
                   std::size_t first) noexcept {
  return {&places[corners[first]], &places[corners[(first + 1) % 3]],
          &places[corners[(first + 2) % 3]]};
}

/// Collects pairs, sorted at the end.
std::vector<TrianglePair> sorted_pairs(std::vector<TrianglePair> pairs, std::size_t most) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
  if (pairs.size() > most) pairs.resize(most);
  return pairs;
}

} // namespace

bool is_degenerate(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept {
  return axis_with_area(a, b, c) == 3;
}

bool triangles_meet(std::span<const SpacePoint> places, const Corners& one, const Corners& other) {
  const Shared shared = shared_by(one, other);
  if (shared.count == 0)
    return strangers_meet(places_of(places, one, 0), places_of(places, other, 0));
  const auto of_other = static_cast<std::size_t>(
      std::find(shared.in_other.begin(), shared.in_other.end(), shared.count == 1) -
      shared.in_other.begin());
  if (shared.count == 1) {
    // What they share beyond the vertex reaches an edge opposite to it.
    const Triangle a = places_of(places, one, shared.of_one[0]);
    const Triangle b = places_of(places, other, of_other);
    return edge_meets(*a[1], *a[2], b) || edge_meets(*b[1], *b[2], a);
  }
  if (shared.count > 2) return true;
  const std::size_t tip = 3 - shared.of_one[0] - shared.of_one[1];
  return folded_onto(places_of(places, one, (tip + 1) % 3), places[other[of_other]]);
}

std::vector<TrianglePair> intersections_between(std::span<const SpacePoint> places,
                                                std::span<const Corners> triangles,
                                                std::span<const std::uint32_t> some,
                                                std::span<const std::uint32_t> others,
                                                std::size_t most) {
  std::vector<TrianglePair> found;
  if (some.empty() || others.empty()) return found;
  const BoxTree tree(places, triangles, {some.begin(), some.end()});
  std::vector<std::uint32_t> near;
  for (const std::uint32_t triangle : others)
    if (meet(tree.box(), box_of(places, triangles[triangle]))) near.push_back(triangle);
  const BoxTree near_tree(places, triangles, std::move(near));
  tree.visit_pairs(near_tree, [&](std::uint32_t mine, std::uint32_t other) {
    if (mine != other && found.size() < most &&
        triangles_meet(places, triangles[mine], triangles[other]))
      found.push_back(std::minmax(mine, other));
  });
  return sorted_pairs(std::move(found), most);
}

std::vector<TrianglePair> self_intersections_of(std::span<const SpacePoint> places,
                                                std::span<const Corners> triangles,
                                                std::span<const std::uint32_t> changed,
                                                std::size_t most) {
  std::vector<char> is_changed(triangles.size(), 0);
  std::vector<TrianglePair> found;
  for (const std::uint32_t triangle : changed) {
    is_changed[triangle] = 1;
    const Corners& corner = triangles[triangle];
    if (is_degenerate(places[corner[0]], places[corner[1]], places[corner[2]]))
      found.emplace_back(triangle, triangle);
  }
  std::vector<std::uint32_t> others;
  for (std::uint32_t triangle = 0; triangle < triangles.size(); ++triangle)
    if (!is_changed[triangle]) others.push_back(triangle);
  const auto append = [&](const std::vector<TrianglePair>& more) {
    found.insert(found.end(), more.begin(), more.end());
  };
  append(intersections_between(places, triangles, changed, others, most));
  const BoxTree tree(places, triangles, {changed.begin(), changed.end()});
  tree.visit_pairs(tree, [&](std::uint32_t one, std::uint32_t other) {
    if (one < other && found.size() < most &&
        triangles_meet(places, triangles[one], triangles[other]))
      found.emplace_back(one, other);
  });
  return sorted_pairs(std::move(found), most);
}

std::vector<TrianglePair> self_intersections(std::span<const SpacePoint> places,
                                             std::span<const Corners> triangles, std::size_t most) {
  std::vector<std::uint32_t> all(triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return self_intersections_of(places, triangles, all, most);
}

} // namespace nendo::deform
