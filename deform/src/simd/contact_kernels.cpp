#include "simd/contact_kernels.hpp"

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

HWY_INLINE ContactV squared_norm(const Vectors3<ContactV>& a) {
  return hn::MulAdd(a.x, a.x, hn::MulAdd(a.y, a.y, hn::Mul(a.z, a.z)));
}

template <class Entry>
HWY_INLINE Vectors3<ContactV> relative_to(ContactTag d, const Entry& entry,
                                          const Vectors3<ContactV>& place) {
  return {hn::Sub(place.x, hn::Set(d, entry.x)), hn::Sub(place.y, hn::Set(d, entry.y)),
          hn::Sub(place.z, hn::Set(d, entry.z))};
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
  const ContactV across_squared =
      hn::NegMulAdd(hn::Mul(along, along), hn::Set(d, cone.squared_length), squared_norm(from));
  const ContactV across = hn::Sqrt(hn::Max(across_squared, zero));
  ContactV share = hn::MulAdd(across, hn::Set(d, cone.tilt), along);
  share = hn::Min(hn::Max(share, zero), hn::Set(d, 1.0F));
  const Vectors3<ContactV> left{hn::NegMulAdd(share, hn::Set(d, cone.way[0]), from.x),
                                hn::NegMulAdd(share, hn::Set(d, cone.way[1]), from.y),
                                hn::NegMulAdd(share, hn::Set(d, cone.way[2]), from.z)};
  const ContactV radius = hn::MulAdd(share, hn::Set(d, cone.growth), hn::Set(d, cone.radius));
  take_if_nearer(hn::Sub(hn::Sqrt(squared_norm(left)), radius), left, place, part, best);
}

/// Returns whether all places are nearest to the triangle's inside. Its edges are then no nearer.
HWY_INLINE bool visit_plane(ContactTag d, const PlaneEntry& plane, const Vectors3<ContactV>& place,
                            ContactV part, NearestVectors& best) {
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
  const Vectors3<ContactV> foot{hn::Sub(from.x, left.x), hn::Sub(from.y, left.y),
                                hn::Sub(from.z, left.z)};
  const ContactV first = product(d, foot, plane.first);
  const ContactV second = product(d, foot, plane.second);
  const ContactV third = hn::Sub(hn::Set(d, 1.0F), hn::Add(first, second));
  const auto inside = hn::Ge(hn::Min(hn::Min(first, second), third), zero);
  const ContactV radius = hn::Add(hn::Set(d, plane.radius), product(d, foot, plane.slope));
  const ContactV distance = hn::Sub(hn::Sqrt(squared_norm(left)), radius);
  take_if_nearer(hn::IfThenElse(inside, distance, hn::Inf(d)), left, place, part, best);
  return hn::AllTrue(d, inside);
}

HWY_INLINE void visit_part(ContactTag d, const PartArrays& arrays, const PartEntry& entry,
                           const Vectors3<ContactV>& place, ContactV part, NearestVectors& best) {
  if (entry.plane != no_plane &&
      visit_plane(d, arrays.planes[entry.plane], place, part, best)) // all before its inside
    return;
  for (std::uint32_t cone = 0; cone < entry.cone_count; ++cone)
    visit_cone(d, arrays.cones[entry.first_cone + cone], place, part, best);
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
                float* distances, float* least) {
  const ContactTag d;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const Vectors3<ContactV> place = load_vectors(d, boxes.middles, lane);
    NearestVectors best{hn::Inf(d), hn::Zero(d), place};
    visit_part(d, arrays, arrays.parts[part], place, hn::Zero(d), best);
    const Vectors3<ContactV> half = load_vectors(d, boxes.halves, lane);
    const Vectors3<ContactV> way{hn::Sub(place.x, best.centre.x), hn::Sub(place.y, best.centre.y),
                                 hn::Sub(place.z, best.centre.z)};
    const ContactV length = hn::Max(hn::Sqrt(squared_norm(way)), hn::Set(d, 1e-30F));
    const ContactV falls =
        hn::MulAdd(hn::Abs(way.x), half.x,
                   hn::MulAdd(hn::Abs(way.y), half.y, hn::Mul(hn::Abs(way.z), half.z)));
    hn::StoreU(best.distance, d, distances + lane);
    hn::StoreU(hn::Sub(best.distance, hn::Div(falls, length)), d, least + lane);
  }
}

BlockBounds bounds_by_vectors(const VertexBlock& block) {
  return vector_bounds(ContactTag(), block);
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(nearest_lanes);
HWY_EXPORT(part_lanes);
HWY_EXPORT(bounds_by_vectors);

void nearest_in_block(const VertexBlock& block, const PartArrays& arrays, const std::uint32_t* list,
                      std::size_t count, NearestLanes& nearest) noexcept {
  HWY_DYNAMIC_DISPATCH(nearest_lanes)(block, arrays, list, count, nearest);
}

void part_from_boxes(const BoxLanes& boxes, const PartArrays& arrays, std::uint32_t part,
                     float* distances, float* least) noexcept {
  HWY_DYNAMIC_DISPATCH(part_lanes)(boxes, arrays, part, distances, least);
}

BlockBounds fast_bounds_of(const VertexBlock& block) noexcept {
  return HWY_DYNAMIC_DISPATCH(bounds_by_vectors)(block);
}

} // namespace nendo::deform
#endif
