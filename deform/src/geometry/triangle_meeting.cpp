#include "geometry/triangle_meeting.hpp"

#include <algorithm>
#include <cmath>

namespace nendo::deform {
namespace {

struct Corners3 {
  const SpacePoint *a, *b, *c;
};

/// The projection along an axis.
PlanePoint along_axis(const SpacePoint& point, std::size_t axis) noexcept {
  return {point[(axis + 1) % 3], point[(axis + 2) % 3]};
}

/// Two segments in the plane have a point in common.
bool segments_meet(const PlanePoint& p, const PlanePoint& q, const PlanePoint& a,
                   const PlanePoint& b) noexcept {
  const int at_p = orient_2d(a, b, p);
  const int at_q = orient_2d(a, b, q);
  const int at_a = orient_2d(p, q, a);
  const int at_b = orient_2d(p, q, b);
  if (at_p * at_q > 0 || at_a * at_b > 0) return false;
  if (at_p != 0 || at_q != 0 || at_a != 0 || at_b != 0) return true;
  for (std::size_t k = 0; k < 2; ++k)
    if (std::max(p[k], q[k]) < std::min(a[k], b[k]) || std::max(a[k], b[k]) < std::min(p[k], q[k]))
      return false;
  return true;
}

/// A segment and a triangle of one plane have a point in common. A triangle without area has none.
bool flat_segment_meets(const SpacePoint& p, const SpacePoint& q, const Corners3& t) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::array corners{along_axis(*t.a, axis), along_axis(*t.b, axis),
                             along_axis(*t.c, axis)};
    const int turn = orient_2d(corners[0], corners[1], corners[2]);
    if (turn == 0) continue;
    const PlanePoint from = along_axis(p, axis);
    const PlanePoint to = along_axis(q, axis);
    bool inside = true;
    for (std::size_t k = 0; k < 3; ++k) {
      const PlanePoint& a = corners[k];
      const PlanePoint& b = corners[(k + 1) % 3];
      if (segments_meet(from, to, a, b)) return true;
      inside = inside && orient_2d(a, b, from) * turn >= 0;
    }
    return inside;
  }
  return false;
}

bool segment_meets(const SpacePoint& p, const SpacePoint& q, const Corners3& t) noexcept {
  const int at_p = orient_3d(*t.a, *t.b, *t.c, p);
  const int at_q = orient_3d(*t.a, *t.b, *t.c, q);
  if (at_p == at_q) return at_p == 0 && flat_segment_meets(p, q, t);
  const int ab = orient_3d(p, q, *t.a, *t.b);
  const int bc = orient_3d(p, q, *t.b, *t.c);
  const int ca = orient_3d(p, q, *t.c, *t.a);
  return (ab >= 0 && bc >= 0 && ca >= 0) || (ab <= 0 && bc <= 0 && ca <= 0);
}

/// Triangles with a shared edge overlap if they lie in one plane, on the same side of it.
bool fold_meets(const SpacePoint& a, const SpacePoint& b, const SpacePoint& one,
                const SpacePoint& other) noexcept {
  if (orient_3d(a, b, one, other) != 0) return false;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const PlanePoint from = along_axis(a, axis);
    const PlanePoint to = along_axis(b, axis);
    const int side = orient_2d(from, to, along_axis(one, axis));
    if (side != 0) return side == orient_2d(from, to, along_axis(other, axis));
  }
  return false;
}

/// The axis along which the triangle looks largest.
std::size_t broad_axis(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept {
  const SpacePoint area = area_vector(a, b, c);
  std::size_t broad = 0;
  for (const std::size_t axis : {1U, 2U})
    if (std::abs(area[axis]) > std::abs(area[broad])) broad = axis;
  return broad;
}

/// Seen along the broad axis of the first triangle, an edge of it has the other triangle beyond,
/// and touches it at most in shared corners. That is so for most pairs, and costs little.
bool are_parted(std::span<const SpacePoint> points, const Corners& one,
                const Corners& other) noexcept {
  const std::size_t axis = broad_axis(points[one[0]], points[one[1]], points[one[2]]);
  const auto flat = [&](std::uint32_t corner) { return along_axis(points[corner], axis); };
  const std::array corners{flat(one[0]), flat(one[1]), flat(one[2])};
  const std::array others{flat(other[0]), flat(other[1]), flat(other[2])};
  const int turn = orient_2d(corners[0], corners[1], corners[2]);
  if (turn == 0) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t next = (k + 1) % 3;
    bool parts = true;
    for (std::size_t m = 0; m < 3 && parts; ++m)
      parts = other[m] == one[k] || other[m] == one[next] ||
              orient_2d(corners[k], corners[next], others[m]) == -turn;
    if (parts) return true;
  }
  return false;
}

} // namespace

bool triangles_meet(std::span<const SpacePoint> points, const Corners& one,
                    const Corners& other) noexcept {
  if (are_parted(points, one, other) || are_parted(points, other, one)) return false;
  // Shared corners to the front, in the same order.
  Corners a = one;
  Corners b = other;
  std::size_t shared = 0;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t m = shared; m < 3; ++m)
      if (a[k] == b[m]) {
        std::swap(b[m], b[shared]);
        std::swap(a[k], a[shared]);
        ++shared;
        break;
      }
  const auto at = [&](std::uint32_t corner) -> const SpacePoint& { return points[corner]; };
  if (shared == 3) return true;
  if (shared == 2) return fold_meets(at(a[0]), at(a[1]), at(a[2]), at(b[2]));
  const Corners3 first{&at(a[0]), &at(a[1]), &at(a[2])};
  const Corners3 second{&at(b[0]), &at(b[1]), &at(b[2])};
  if (shared == 1)
    return segment_meets(*first.b, *first.c, second) || segment_meets(*second.b, *second.c, first);
  // Many of the others are parted by the plane of one of them.
  for (const auto& [plane, of] : {std::pair{&first, &second}, std::pair{&second, &first}}) {
    const int turn = orient_3d(*plane->a, *plane->b, *plane->c, *of->a);
    if (turn != 0 && turn == orient_3d(*plane->a, *plane->b, *plane->c, *of->b) &&
        turn == orient_3d(*plane->a, *plane->b, *plane->c, *of->c))
      return false;
  }
  return segment_meets(*first.a, *first.b, second) || segment_meets(*first.b, *first.c, second) ||
         segment_meets(*first.c, *first.a, second) || segment_meets(*second.a, *second.b, first) ||
         segment_meets(*second.b, *second.c, first) || segment_meets(*second.c, *second.a, first);
}

bool is_degenerate(const SpacePoint& a, const SpacePoint& b, const SpacePoint& c) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (orient_2d(along_axis(a, axis), along_axis(b, axis), along_axis(c, axis)) != 0) return false;
  return true;
}

} // namespace nendo::deform
