#include "simd/contact_kernels.hpp"

#include <limits>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/contact_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using ContactTag = hn::ScalableTag<float>;
using ContactV = hn::Vec<ContactTag>;

struct NearestVectors {
  ContactV distance, part;
  Vectors3<ContactV> centre;
};

HWY_INLINE ContactV product(ContactTag d, const Vectors3<ContactV>& a,
                            const std::array<float, 3>& b) {
  return hn::MulAdd(a.x, hn::Set(d, b[0]),
                    hn::MulAdd(a.y, hn::Set(d, b[1]), hn::Mul(a.z, hn::Set(d, b[2]))));
}

/// `from_centre` leads from the ball's centre to the place.
HWY_INLINE void take_if_nearer(ContactV distance, const Vectors3<ContactV>& from_centre,
                               const Vectors3<ContactV>& place, ContactV part,
                               NearestVectors& best) {
  const auto nearer = hn::Lt(distance, best.distance);
  best.distance = hn::IfThenElse(nearer, distance, best.distance);
  best.part = hn::IfThenElse(nearer, part, best.part);
  best.centre.x = hn::IfThenElse(nearer, hn::Sub(place.x, from_centre.x), best.centre.x);
  best.centre.y = hn::IfThenElse(nearer, hn::Sub(place.y, from_centre.y), best.centre.y);
  best.centre.z = hn::IfThenElse(nearer, hn::Sub(place.z, from_centre.z), best.centre.z);
}

HWY_INLINE void visit_cone(ContactTag d, const ConeEntry& cone, const Vectors3<ContactV>& place,
                           ContactV part, NearestVectors& best) {
  const ContactV zero = hn::Zero(d);
  const Vectors3<ContactV> from = relative_to(d, cone, place);
  const ContactV along = hn::Mul(product(d, from, cone.way), hn::Set(d, cone.inverse_squared));
  const ContactV across_squared = hn::NegMulAdd(
      hn::Mul(along, along), hn::Set(d, cone.squared_length), dot_product(from, from));
  const ContactV across = hn::Sqrt(hn::Max(across_squared, zero));
  ContactV share = hn::MulAdd(across, hn::Set(d, cone.tilt), along);
  share = hn::Min(hn::Max(share, zero), hn::Set(d, 1.0F));
  const Vectors3<ContactV> left{hn::NegMulAdd(share, hn::Set(d, cone.way[0]), from.x),
                                hn::NegMulAdd(share, hn::Set(d, cone.way[1]), from.y),
                                hn::NegMulAdd(share, hn::Set(d, cone.way[2]), from.z)};
  const ContactV radius = hn::MulAdd(share, hn::Set(d, cone.growth), hn::Set(d, cone.radius));
  take_if_nearer(hn::Sub(hn::Sqrt(dot_product(left, left)), radius), left, place, part, best);
}

/// For each place the part of a triangle's distance that depends on its inside, and whether an edge
/// may be nearer: those edges beyond which the best place of the whole plane lies. The distance is
/// convex in the plane, so that from the nearest place of the triangle the way to the best one
/// leaves it.
struct BesidePlane {
  bool first, second, third; ///< some place lies beyond the edge that is opposite to that corner
};

HWY_INLINE BesidePlane visit_plane(ContactTag d, const PlaneEntry& plane,
                                   const Vectors3<ContactV>& place, ContactV part,
                                   NearestVectors& best) {
  const ContactV zero = hn::Zero(d);
  const Vectors3<ContactV> from = relative_to(d, plane, place);
  const ContactV height = product(d, from, plane.normal);
  const ContactV to_thick = hn::Mul(hn::Abs(height), hn::Set(d, plane.tilt));
  // left = height * normal - to_thick * slope, and the foot is what is left of `from`.
  const auto left_along = [&](std::size_t axis) HWY_ATTR {
    return hn::NegMulAdd(to_thick, hn::Set(d, plane.slope[axis]),
                         hn::Mul(height, hn::Set(d, plane.normal[axis])));
  };
  const Vectors3<ContactV> left{left_along(0), left_along(1), left_along(2)};
  const Vectors3<ContactV> foot = difference_of(from, left);
  const ContactV first = product(d, foot, plane.first);
  const ContactV second = product(d, foot, plane.second);
  const ContactV third = hn::Sub(hn::Set(d, 1.0F), hn::Add(first, second));
  const auto inside = hn::Ge(hn::Min(hn::Min(first, second), third), zero);
  const BesidePlane beside{!hn::AllTrue(d, hn::Ge(first, zero)),
                           !hn::AllTrue(d, hn::Ge(second, zero)),
                           !hn::AllTrue(d, hn::Ge(third, zero))};
  if (hn::AllFalse(d, inside)) return beside;
  const ContactV radius = hn::Add(hn::Set(d, plane.radius), product(d, foot, plane.slope));
  const ContactV distance = hn::Sub(hn::Sqrt(dot_product(left, left)), radius);
  take_if_nearer(hn::IfThenElse(inside, distance, hn::Inf(d)), left, place, part, best);
  return beside;
}

/// The edges of a triangle are the cones from its corners 0 to 1, 1 to 2, and 2 to 0.
HWY_INLINE void visit_part(ContactTag d, const PartArrays& arrays, const PartEntry& entry,
                           const Vectors3<ContactV>& place, ContactV part, NearestVectors& best) {
  const ConeEntry* const cones = arrays.cones + entry.first_cone;
  if (entry.plane == no_plane) {
    for (std::uint32_t cone = 0; cone < entry.cone_count; ++cone)
      visit_cone(d, cones[cone], place, part, best);
    return;
  }
  const BesidePlane beside = visit_plane(d, arrays.planes[entry.plane], place, part, best);
  if (beside.second) visit_cone(d, cones[0], place, part, best);
  if (beside.third) visit_cone(d, cones[1], place, part, best);
  if (beside.first) visit_cone(d, cones[2], place, part, best);
}

void nearest_lanes(const VertexBlock& block, const PartArrays& arrays, const std::uint32_t* list,
                   std::size_t count, NearestLanes& nearest) {
  const ContactTag d;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const Vectors3<ContactV> place = load_vectors(d, block, lane);
    NearestVectors best{hn::Inf(d), hn::Zero(d), place};
    for (std::size_t at = 0; at < count; ++at) {
      const PartEntry& entry = arrays.parts[list[at]];
      const ContactV part = hn::Set(d, static_cast<float>(list[at]));
      visit_part(d, arrays, entry, place, part, best);
    }
    hn::Store(best.distance, d, nearest.distance.data() + lane);
    hn::Store(best.part, d, nearest.part.data() + lane);
    hn::Store(best.centre.x, d, nearest.x.data() + lane);
    hn::Store(best.centre.y, d, nearest.y.data() + lane);
    hn::Store(best.centre.z, d, nearest.z.data() + lane);
  }
}

void part_lanes(const BoxLanes& boxes, const PartArrays& arrays, std::uint32_t part,
                PartFromBoxes& seen, NearestFromBoxes& nearest) {
  const ContactTag d;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const Vectors3<ContactV> place = load_vectors(d, boxes.middles, lane);
    NearestVectors best{hn::Inf(d), hn::Zero(d), place};
    visit_part(d, arrays, arrays.parts[part], place, hn::Zero(d), best);
    const Vectors3<ContactV> half = load_vectors(d, boxes.halves, lane);
    const Vectors3<ContactV> way = difference_of(place, best.centre);
    const ContactV length = hn::Max(hn::Sqrt(dot_product(way, way)), hn::Set(d, 1e-30F));
    const ContactV inverse = hn::Div(hn::Set(d, 1.0F), length);
    const Vectors3<ContactV> away = scaled(way, inverse);
    const ContactV falls = spread_of(away, half);
    const auto nearer = hn::Lt(best.distance, hn::Load(d, nearest.distance.data() + lane));
    const auto set = [&](ContactV value, std::array<float, block_size>& of_part,
                         std::array<float, block_size>& of_nearest) HWY_ATTR {
      hn::Store(value, d, of_part.data() + lane);
      hn::Store(hn::IfThenElse(nearer, value, hn::Load(d, of_nearest.data() + lane)), d,
                of_nearest.data() + lane);
    };
    set(best.distance, seen.distance, nearest.distance);
    set(away.x, seen.x, nearest.x);
    set(away.y, seen.y, nearest.y);
    set(away.z, seen.z, nearest.z);
    set(length, seen.least, nearest.to_centre);
    hn::Store(hn::Sub(best.distance, falls), d, seen.least.data() + lane);
  }
}

std::uint64_t near_lanes(const BoxLanes& boxes, const PartFromBoxes& seen,
                         const NearestFromBoxes& nearest, float margin) {
  const ContactTag d;
  std::uint64_t near = 0;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const auto of = [&](const std::array<float, block_size>& numbers)
                        HWY_ATTR { return hn::Load(d, numbers.data() + lane); };
    const Vectors3<ContactV> half = load_vectors(d, boxes.halves, lane);
    const Vectors3<ContactV> seen_away{of(seen.x), of(seen.y), of(seen.z)};
    const Vectors3<ContactV> nearest_away{of(nearest.x), of(nearest.y), of(nearest.z)};
    const ContactV turns = spread_of(difference_of(seen_away, nearest_away), half);
    const ContactV squared = dot_product(half, half);
    const ContactV bends = hn::Div(hn::Mul(hn::Set(d, 0.5F), squared), of(nearest.to_centre));
    const ContactV farther = hn::Sub(of(seen.distance), of(nearest.distance));
    const ContactV beyond = hn::Sub(of(seen.least), hn::Set(d, margin));
    const ContactV size = hn::Add(hn::Abs(of(nearest.distance)), hn::Sqrt(squared));
    const ContactV rounding = hn::MulAdd(hn::Set(d, 1e-5F), size, hn::Set(d, 1e-5F));
    const ContactV more = hn::Max(hn::Sub(farther, hn::Add(turns, bends)), beyond);
    near |= bits_of(d, hn::Le(more, rounding)) << lane;
  }
  return near;
}

/// A number for each cell: ten bits of each coordinate's.
HWY_INLINE hn::Vec<hn::RebindToSigned<ContactTag>>
cell_keys(ContactTag d, const VertexBlock& block, std::size_t lane, const SpaceCells& cells) {
  const hn::RebindToSigned<ContactTag> di;
  const auto cell_of = [&](ContactV coordinate) HWY_ATTR {
    const ContactV cell =
        hn::MulAdd(coordinate, hn::Set(d, cells.per_length), hn::Set(d, cells.shift));
    const ContactV inside = hn::Min(hn::Max(cell, hn::Zero(d)), hn::Set(d, cells.most));
    return hn::And(hn::ConvertTo(di, inside), hn::Set(di, 1023));
  };
  const Vectors3<ContactV> place = load_vectors(d, block, lane);
  return hn::Or(cell_of(place.x),
                hn::Or(hn::ShiftLeft<10>(cell_of(place.y)), hn::ShiftLeft<20>(cell_of(place.z))));
}

/// The first lane that has this number; some lane must.
HWY_INLINE std::size_t first_of(ContactTag d, const std::array<float, block_size>& numbers,
                                ContactV number) {
  for (std::size_t lane = 0;; lane += hn::Lanes(d)) {
    const auto at = hn::FindFirstTrue(d, hn::Eq(hn::Load(d, numbers.data() + lane), number));
    if (at >= 0) return lane + static_cast<std::size_t>(at);
  }
}

std::size_t nearest_lane_of_cells(const VertexBlock& block, const NearestLanes& nearest,
                                  float margin, const SpaceCells& cells,
                                  std::array<std::uint8_t, block_size>& lanes) {
  const ContactTag d;
  const hn::RebindToSigned<ContactTag> di;
  constexpr float none = std::numeric_limits<float>::max();
  alignas(64) std::array<float, block_size> left;
  alignas(64) std::array<std::int32_t, block_size> keys;
  ContactV least = hn::Set(d, none);
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const ContactV distance = hn::Load(d, nearest.distance.data() + lane);
    const auto is_near = hn::Lt(distance, hn::Set(d, margin));
    const ContactV here = hn::IfThenElse(is_near, distance, hn::Set(d, none));
    hn::Store(here, d, left.data() + lane);
    hn::Store(cell_keys(d, block, lane, cells), di, keys.data() + lane);
    least = hn::Min(least, here);
  }
  for (std::size_t count = 0;; ++count) {
    const ContactV nearest_left = hn::MinOfLanes(d, least);
    if (!(hn::GetLane(nearest_left) < none)) return count;
    const std::size_t first = first_of(d, left, nearest_left);
    lanes[count] = static_cast<std::uint8_t>(first);
    const auto key = hn::Set(di, keys[first]);
    const ContactV part = hn::Set(d, nearest.part[first]);
    least = hn::Set(d, none);
    for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
      const auto same_cell = hn::RebindMask(d, hn::Eq(hn::Load(di, keys.data() + lane), key));
      const auto same_part = hn::Eq(hn::Load(d, nearest.part.data() + lane), part);
      const ContactV here = hn::IfThenElse(hn::And(same_cell, same_part), hn::Set(d, none),
                                           hn::Load(d, left.data() + lane));
      hn::Store(here, d, left.data() + lane);
      least = hn::Min(least, here);
    }
  }
}

bool load_lanes(const NearestLanes& nearest, float most, float* loads) {
  const ContactTag d;
  const ContactV zero = hn::Zero(d);
  ContactV largest = zero;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const ContactV distance = hn::Load(d, nearest.distance.data() + lane);
    const ContactV depth = hn::Max(hn::Neg(distance), zero);
    const ContactV sum = hn::Min(hn::Add(hn::LoadU(d, loads + lane), depth), hn::Set(d, most));
    const ContactV load = hn::IfThenElseZero(hn::Le(distance, hn::Set(d, most)), sum);
    hn::StoreU(load, d, loads + lane);
    largest = hn::Max(largest, load);
  }
  return hn::GetLane(hn::MaxOfLanes(d, largest)) > 0.0F;
}

/// All are looked at, because that is faster than a search that ends early.
bool is_any_near(const PlaceRows& rows, std::size_t count, const std::array<float, 6>& place,
                 float squared) {
  const ContactTag d;
  ContactV crowding = hn::Zero(d);
  for (std::size_t at = 0; at < count; at += hn::Lanes(d)) {
    const auto number = [&](std::size_t row) HWY_ATTR { return hn::LoadU(d, rows[row] + at); };
    const auto away = [&](std::size_t row)
                          HWY_ATTR { return hn::Sub(number(row), hn::Set(d, place[row])); };
    const auto x = away(0), y = away(1), z = away(2);
    const auto distance = hn::MulAdd(x, x, hn::MulAdd(y, y, hn::Mul(z, z)));
    const auto along = hn::MulAdd(
        number(3), hn::Set(d, place[3]),
        hn::MulAdd(number(4), hn::Set(d, place[4]), hn::Mul(number(5), hn::Set(d, place[5]))));
    const auto is_one =
        hn::And(hn::Lt(distance, hn::Set(d, squared)), hn::Gt(along, hn::Set(d, 0.5F)));
    crowding = hn::IfThenElse(is_one, hn::Set(d, 1.0F), crowding);
  }
  return !hn::AllTrue(d, hn::Eq(crowding, hn::Zero(d)));
}

std::uint64_t overlapping_lanes(const BoxRows& rows, std::size_t first,
                                const std::array<float, 8>& sides) {
  const ContactTag d;
  std::uint64_t overlapping = 0;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const auto gap = [&](std::size_t row, std::size_t side) HWY_ATTR {
      return hn::Add(hn::LoadU(d, rows[row] + first + lane), hn::Set(d, sides[side]));
    };
    const ContactV widest =
        hn::Max(hn::Max(gap(0, 4), hn::Max(gap(1, 5), gap(2, 6))), hn::Max(gap(3, 1), gap(4, 2)));
    overlapping |= bits_of(d, hn::Le(widest, hn::Zero(d))) << lane;
  }
  return overlapping;
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(nearest_lanes);
HWY_EXPORT(part_lanes);
HWY_EXPORT(near_lanes);
HWY_EXPORT(nearest_lane_of_cells);
HWY_EXPORT(load_lanes);
HWY_EXPORT(is_any_near);
HWY_EXPORT(overlapping_lanes);

void nearest_in_block(const VertexBlock& block, const PartArrays& arrays, const std::uint32_t* list,
                      std::size_t count, NearestLanes& nearest) noexcept {
  HWY_DYNAMIC_DISPATCH(nearest_lanes)(block, arrays, list, count, nearest);
}

void part_from_boxes(const BoxLanes& boxes, const PartArrays& arrays, std::uint32_t part,
                     PartFromBoxes& seen, NearestFromBoxes& nearest) noexcept {
  HWY_DYNAMIC_DISPATCH(part_lanes)(boxes, arrays, part, seen, nearest);
}

std::uint64_t near_in_boxes(const BoxLanes& boxes, const PartFromBoxes& seen,
                            const NearestFromBoxes& nearest, float margin) noexcept {
  return HWY_DYNAMIC_DISPATCH(near_lanes)(boxes, seen, nearest, margin);
}

std::size_t nearest_of_cells(const VertexBlock& block, const NearestLanes& nearest, float margin,
                             const SpaceCells& cells,
                             std::array<std::uint8_t, block_size>& lanes) noexcept {
  return HWY_DYNAMIC_DISPATCH(nearest_lane_of_cells)(block, nearest, margin, cells, lanes);
}

bool add_loads(const NearestLanes& nearest, float most, float* loads) noexcept {
  return HWY_DYNAMIC_DISPATCH(load_lanes)(nearest, most, loads);
}

bool is_crowded(const PlaceRows& rows, std::size_t count, const std::array<float, 6>& place,
                float squared) noexcept {
  return HWY_DYNAMIC_DISPATCH(is_any_near)(rows, count, place, squared);
}

std::uint64_t boxes_in_way(const BoxRows& rows, std::size_t first,
                           const std::array<float, 8>& sides) noexcept {
  return HWY_DYNAMIC_DISPATCH(overlapping_lanes)(rows, first, sides);
}

} // namespace nendo::deform
#endif
