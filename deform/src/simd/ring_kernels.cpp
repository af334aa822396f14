#include "simd/ring_kernels.hpp"

#include <algorithm>
#include <cmath>

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "simd/ring_kernels.cpp"
#include "simd/targets.hpp"

#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "simd/kernels-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace nendo::deform::HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

using RingTag = hn::CappedTag<float, block_size>;
using RingV = hn::Vec<RingTag>;
using Ring3 = Vectors3<RingV>;

constexpr float min_square = 1e-30F; // instead of a division by 0
constexpr float min_even = 0.3F;     // cosine of the angle between face and direction
constexpr float own_share = 0.2F;    // of a vertex' own normal in its direction

HWY_INLINE Ring3 cross_product(const Ring3& a, const Ring3& b) {
  return {hn::NegMulAdd(a.z, b.y, hn::Mul(a.y, b.z)), hn::NegMulAdd(a.x, b.z, hn::Mul(a.z, b.x)),
          hn::NegMulAdd(a.y, b.x, hn::Mul(a.x, b.y))};
}

HWY_INLINE Ring3 masked(hn::Mask<RingTag> mask, const Ring3& a) {
  return {hn::IfThenElseZero(mask, a.x), hn::IfThenElseZero(mask, a.y),
          hn::IfThenElseZero(mask, a.z)};
}

#if HWY_TARGET != HWY_SCALAR
/// The vectors with the numbers in the first byte, the fifth, the ninth, and so on.
template <class D>
HWY_INLINE hn::Vec<D> load_each_fourth(D d, const RingTable& table, const std::uint8_t* first) {
  if constexpr (hn::MaxLanes(D()) == 4) {
    return hn::LoadU(d, table[*first].data());
  } else {
    const hn::Half<D> half;
    return hn::Combine(d, load_each_fourth(half, table, first + hn::MaxLanes(half)),
                       load_each_fourth(half, table, first));
  }
}
#endif

/// The vectors that the row has from `lane` on. They are loaded one by one: many processors'
/// gathering loads take longer.
HWY_INLINE Ring3 load_row(RingTag d, const RingTable& table, const RingRow& row, std::size_t lane) {
#if HWY_TARGET == HWY_SCALAR
  const std::array<float, 4>& at = table[row[lane]];
  return {hn::Set(d, at[0]), hn::Set(d, at[1]), hn::Set(d, at[2])};
#else
  const std::uint8_t* const first = row.data() + lane;
  const RingV a = load_each_fourth(d, table, first), b = load_each_fourth(d, table, first + 1);
  const RingV c = load_each_fourth(d, table, first + 2), e = load_each_fourth(d, table, first + 3);
  const RingV xy_even = hn::InterleaveLower(d, a, c), xy_odd = hn::InterleaveLower(d, b, e);
  const RingV z_even = hn::InterleaveUpper(d, a, c), z_odd = hn::InterleaveUpper(d, b, e);
  return {hn::InterleaveLower(d, xy_even, xy_odd), hn::InterleaveUpper(d, xy_even, xy_odd),
          hn::InterleaveLower(d, z_even, z_odd)};
#endif
}

/// Calls visit(part, row, number) for each row.
template <class Visit>
HWY_INLINE void each_row(const BlockRings& rings, const Visit& visit) {
  std::size_t number = 0;
  for (const RingPart& part : rings.parts)
    for (const RingRow& row : part.rows)
      visit(part, row, static_cast<float>(number++));
}

/// Sums over the ring around each vertex, of ways from it.
struct RingSums {
  Ring3 crosses, ways;
  RingV squares, longest; ///< sum and maximum of the squared ways
  RingV least;            ///< below 0: some face is not even
  RingV smallest;         ///< square of a face's cross product
};

HWY_INLINE RingSums sum_ring(RingTag d, const BlockRings& rings, std::size_t lane,
                             const Ring3& here, const Ring3& direction) {
  const RingV zero = hn::Zero(d);
  const RingV count = hn::LoadU(d, rings.counts + lane);
  RingSums sums{{zero, zero, zero}, {zero, zero, zero}, zero, zero, zero, hn::Set(d, 1e30F)};
  const RingPart& last = rings.parts.back();
  Ring3 before = difference_of(load_row(d, *last.points, last.rows.back(), lane), here);
  each_row(rings, [&](const RingPart& part, const RingRow& row, float number) HWY_ATTR {
    const Ring3 way = difference_of(load_row(d, *part.points, row, lane), here);
    const auto is_one = hn::Lt(hn::Set(d, number), count);
    const Ring3 cross = cross_product(before, way);
    sums.crosses = sum_of(sums.crosses, cross);
    const RingV along = dot_product(cross, direction);
    const RingV squared = dot_product(cross, cross);
    const RingV least = hn::Mul(hn::Set(d, min_even * min_even), squared);
    sums.smallest = hn::Min(sums.smallest, hn::IfThenElse(is_one, squared, sums.smallest));
    sums.least =
        hn::Min(sums.least, hn::IfThenElseZero(is_one, hn::MulSub(along, hn::Abs(along), least)));
    sums.ways = sum_of(sums.ways, masked(is_one, way));
    const RingV square = hn::IfThenElseZero(is_one, dot_product(way, way));
    sums.squares = hn::Add(sums.squares, square);
    sums.longest = hn::Max(sums.longest, square);
    before = way;
  });
  return sums;
}

/// The mean of the neighbours' directions, and a little of the vertex' own normal. Over some rounds
/// it is that of the normals for some edges around. In a crease, vertices on both sides then swell
/// into nearly the same direction; along their own normals they would cross.
HWY_INLINE Ring3 smooth_direction(RingTag d, const BlockRings& rings, std::size_t lane,
                                  const Ring3& normal) {
  const RingV zero = hn::Zero(d);
  const RingV least = hn::Set(d, min_square);
  const RingV count = hn::LoadU(d, rings.counts + lane);
  Ring3 sum{zero, zero, zero};
  each_row(rings, [&](const RingPart& part, const RingRow& row, float number) HWY_ATTR {
    sum = sum_of(
        sum, masked(hn::Lt(hn::Set(d, number), count), load_row(d, *part.directions, row, lane)));
  });
  const RingV length = hn::Sqrt(hn::Max(dot_product(normal, normal), least));
  const RingV own = hn::Mul(hn::Set(d, own_share), hn::Max(count, hn::Set(d, 1.0F)));
  sum = sum_of(sum, scaled(normal, hn::Div(own, length)));
  const RingV squared = hn::Max(dot_product(sum, sum), least);
  return scaled(sum, hn::Div(hn::Set(d, 1.0F), hn::Sqrt(squared)));
}

/// Of all vertices in a lane.
struct LaneFacts {
  RingV longest, least, smallest;
};

/// The volume's derivative by a vertex is a sixth of the sum of its triangles' cross products, and
/// the sum of vertices times derivatives is three times the volume. Where neighbours lie on a
/// circle with a radius of h, their middle is H h^2 / 2 below the vertex, H being the mean
/// curvature; and the area of a surface that moves by f along its normals grows with 2 H f.
HWY_INLINE RingV measure_lanes(RingTag d, const VertexBlock& block, const BlockRings& rings,
                               std::size_t lane, RingBlock& measured, LaneFacts& facts) {
  const RingV one = hn::Set(d, 1.0F);
  const Ring3 here = load_vectors(d, block, lane);
  const RingSums sums = sum_ring(d, rings, lane, here, load_vectors(d, measured.direction, lane));
  const Ring3 normal = scaled(sums.crosses, hn::Set(d, 1.0F / 6.0F));
  if (rings.parts[0].directions != nullptr)
    store_vectors(d, smooth_direction(d, rings, lane, normal), measured.direction, lane);
  const Ring3 direction = load_vectors(d, measured.direction, lane);
  facts.longest = hn::Max(facts.longest, sums.longest);
  facts.least = hn::Min(facts.least, sums.least);
  facts.smallest = hn::Min(facts.smallest, sums.smallest);
  const RingV count = hn::LoadU(d, rings.counts + lane);
  const RingV per_square = hn::Div(count, hn::Max(sums.squares, hn::Set(d, min_square)));
  const Ring3 middle = scaled(sums.ways, hn::Div(one, hn::Max(count, one)));
  const RingV height = dot_product(middle, direction);
  const RingV rate = dot_product(direction, normal);
  const RingV curvature = hn::Mul(hn::Set(d, -2.0F), hn::Mul(height, per_square));
  // Where the middle is outside, all the way to it: that fills creases.
  const Ring3 inwards = scaled(direction, hn::Min(height, hn::Zero(d)));
  store_vectors(d, difference_of(middle, inwards), measured.fairing, lane);
  hn::Store(hn::Sqrt(per_square), d, measured.per_edge.data() + lane);
  hn::Store(rate, d, measured.rate.data() + lane);
  hn::Store(hn::Mul(curvature, rate), d, measured.bend.data() + lane);
  return dot_product(here, normal);
}

void put_lanes(const VertexBlock& block, RingTable& table) {
  const RingTag d;
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const Ring3 at = load_vectors(d, block, lane);
    hn::StoreInterleaved4(at.x, at.y, at.z, hn::Zero(d), d, table[lane].data());
  }
}

/// In eight sums, so that each is not waited for.
double double_sum(const std::array<float, block_size>& numbers) {
  std::array<double, 8> sums{};
  for (std::size_t lane = 0; lane < block_size; lane += sums.size())
    for (std::size_t at = 0; at < sums.size(); ++at)
      sums[at] += static_cast<double>(numbers[lane + at]);
  return ((sums[0] + sums[4]) + (sums[1] + sums[5])) + ((sums[2] + sums[6]) + (sums[3] + sums[7]));
}

/// The middle of the directions, and how far they are from it.
void find_axis(RingTag d, const VertexBlock& directions, RingFacts& facts) {
  const RingV zero = hn::Zero(d);
  Ring3 sum{zero, zero, zero};
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d))
    sum = sum_of(sum, load_vectors(d, directions, lane));
  facts.axis = {hn::GetLane(hn::SumOfLanes(d, sum.x)), hn::GetLane(hn::SumOfLanes(d, sum.y)),
                hn::GetLane(hn::SumOfLanes(d, sum.z))};
  auto& [x, y, z] = facts.axis;
  const float length = std::sqrt(std::max(x * x + y * y + z * z, min_square));
  for (float& coordinate : facts.axis)
    coordinate /= length;
  const Ring3 axis{hn::Set(d, x), hn::Set(d, y), hn::Set(d, z)};
  RingV least = hn::Set(d, 1.0F);
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d))
    least = hn::Min(least, dot_product(axis, load_vectors(d, directions, lane)));
  facts.min_cosine = hn::GetLane(hn::MinOfLanes(d, least));
  facts.sine = std::sqrt(std::max(1.0F - facts.min_cosine * facts.min_cosine, 0.0F));
}

void measure_all_lanes(const VertexBlock& block, const BlockRings& rings, bool is_turned,
                       RingBlock& measured, RingFacts& facts) {
  const RingTag d;
  const RingV zero = hn::Zero(d);
  if (is_turned) find_axis(d, measured.direction, facts); // those that faces are compared with
  LaneFacts lanes{zero, zero, hn::Set(d, 1e30F)};
  alignas(64) std::array<float, block_size> products{};
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d))
    hn::Store(measure_lanes(d, block, rings, lane, measured, lanes), d, products.data() + lane);
  facts.volume = double_sum(products) / 3.0;
  facts.longest_edge = std::sqrt(hn::GetLane(hn::MaxOfLanes(d, lanes.longest)));
  facts.min_height = std::sqrt(hn::GetLane(hn::MinOfLanes(d, lanes.smallest))) /
                     std::max(facts.longest_edge, min_square);
  facts.is_even = !(hn::GetLane(hn::MinOfLanes(d, lanes.least)) < 0.0F);
  facts.may_turn = false;
}

HWY_INLINE RingV smooth_step(RingTag d, RingV t) {
  const RingV s = hn::Min(hn::Max(t, hn::Zero(d)), hn::Set(d, 1.0F));
  return hn::Mul(hn::Mul(s, s), hn::NegMulAdd(hn::Set(d, 2.0F), s, hn::Set(d, 3.0F)));
}

/// By the distance along the farthest axis.
void weigh_lanes_around(const VertexBlock& block, const BlockBounds& box, float reach,
                        float* weights) {
  const RingTag d;
  const auto beyond = [&](RingV coordinate, std::size_t axis) HWY_ATTR {
    return hn::Max(hn::Sub(coordinate, hn::Set(d, box.sides[axis])),
                   hn::Sub(hn::Neg(coordinate), hn::Set(d, box.sides[axis + 4])));
  };
  const RingV inverse = hn::Set(d, 1.0F / reach);
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const Ring3 at = load_vectors(d, block, lane);
    const RingV distance =
        hn::Max(hn::Max(beyond(at.x, 0), beyond(at.y, 1)), hn::Max(beyond(at.z, 2), hn::Zero(d)));
    const RingV weight = smooth_step(d, hn::Sub(hn::Set(d, 1.0F), hn::Mul(distance, inverse)));
    hn::StoreU(weight, d, weights + lane);
  }
}

void hold_lanes(const float* distances, float near, float* weights) {
  const RingTag d;
  const RingV inverse = hn::Set(d, 1.0F / near);
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const RingV free = smooth_step(d, hn::Mul(hn::LoadU(d, distances + lane), inverse));
    hn::StoreU(hn::Mul(hn::LoadU(d, weights + lane), free), d, weights + lane);
  }
}

SwellRates swell_rates_of_lanes(const RingBlock& measured, const float* weights) {
  const RingTag d;
  alignas(64) std::array<float, block_size> rates{}, bends{};
  RingV largest = hn::Zero(d);
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const RingV weight = hn::LoadU(d, weights + lane);
    const RingV rate = hn::Mul(weight, hn::Load(d, measured.rate.data() + lane));
    const RingV bend = hn::Mul(weight, hn::Load(d, measured.bend.data() + lane));
    hn::Store(rate, d, rates.data() + lane);
    hn::Store(hn::Mul(weight, bend), d, bends.data() + lane);
    largest = hn::Max(largest, weight);
  }
  return {double_sum(rates), double_sum(bends), hn::GetLane(hn::MaxOfLanes(d, largest)) > 0.0F};
}

/// The largest coordinate by which vectors in a block differ.
HWY_INLINE float widest_range(RingTag d, const Ring3& low, const Ring3& high) {
  const RingV widest =
      hn::Max(hn::Max(hn::Sub(hn::MaxOfLanes(d, high.x), hn::MinOfLanes(d, low.x)),
                      hn::Sub(hn::MaxOfLanes(d, high.y), hn::MinOfLanes(d, low.y))),
              hn::Sub(hn::MaxOfLanes(d, high.z), hn::MinOfLanes(d, low.z)));
  return hn::GetLane(widest);
}

Swelling swell_lanes(const RingBlock& measured, const float* weights, float far, float fairness,
                     VertexBlock& block) {
  const RingTag d;
  const RingV max_fairing = hn::Set(d, 0.3F);
  const RingV huge = hn::Set(d, 1e30F);
  Ring3 low{huge, huge, huge}, high = scaled(low, hn::Set(d, -1.0F));
  RingV max_squared = hn::Zero(d);
  alignas(64) std::array<float, block_size> grown{};
  for (std::size_t lane = 0; lane < block_size; lane += hn::Lanes(d)) {
    const RingV weight = hn::LoadU(d, weights + lane);
    const RingV per_edge = hn::Load(d, measured.per_edge.data() + lane);
    const RingV fair =
        hn::Mul(weight, hn::Min(max_fairing, hn::Mul(hn::Set(d, fairness), per_edge)));
    const Ring3 direction = load_vectors(d, measured.direction, lane);
    const Ring3 fairing = load_vectors(d, measured.fairing, lane);
    const Ring3 out = scaled(direction, hn::Mul(weight, hn::Set(d, far)));
    const Ring3 by{hn::MulAdd(fairing.x, fair, out.x), hn::MulAdd(fairing.y, fair, out.y),
                   hn::MulAdd(fairing.z, fair, out.z)};
    store_vectors(d, sum_of(load_vectors(d, block, lane), by), block, lane);
    low = {hn::Min(low.x, out.x), hn::Min(low.y, out.y), hn::Min(low.z, out.z)};
    high = {hn::Max(high.x, out.x), hn::Max(high.y, out.y), hn::Max(high.z, out.z)};
    max_squared = hn::Max(max_squared, hn::Mul(hn::Mul(fair, fair), dot_product(fairing, fairing)));
    const RingV rate = hn::Load(d, measured.rate.data() + lane);
    hn::Store(hn::Mul(hn::Mul(fair, dot_product(fairing, direction)), rate), d,
              grown.data() + lane);
  }
  return {double_sum(grown), widest_range(d, low, high),
          std::sqrt(hn::GetLane(hn::MaxOfLanes(d, max_squared)))};
}

} // namespace nendo::deform::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace nendo::deform {

HWY_EXPORT(put_lanes);
HWY_EXPORT(measure_all_lanes);
HWY_EXPORT(weigh_lanes_around);
HWY_EXPORT(hold_lanes);
HWY_EXPORT(swell_rates_of_lanes);
HWY_EXPORT(swell_lanes);

void begin_table(const VertexBlock& block, RingTable& table) noexcept {
  HWY_DYNAMIC_DISPATCH(put_lanes)(block, table);
}

void measure_rings(const VertexBlock& block, const BlockRings& rings, bool is_turned,
                   RingBlock& measured, RingFacts& facts) noexcept {
  if (!rings.parts.empty()) // in some triangle
    HWY_DYNAMIC_DISPATCH(measure_all_lanes)(block, rings, is_turned, measured, facts);
}

void weigh_around_box(const VertexBlock& block, const BlockBounds& box, float reach,
                      float* weights) noexcept {
  HWY_DYNAMIC_DISPATCH(weigh_lanes_around)(block, box, reach, weights);
}

void hold_near_body(const float* distances, float near, float* weights) noexcept {
  HWY_DYNAMIC_DISPATCH(hold_lanes)(distances, near, weights);
}

SwellRates swell_rates(const RingBlock& measured, const float* weights) noexcept {
  return HWY_DYNAMIC_DISPATCH(swell_rates_of_lanes)(measured, weights);
}

Swelling swell_block(const RingBlock& measured, const float* weights, float far, float fairness,
                     VertexBlock& block) noexcept {
  return HWY_DYNAMIC_DISPATCH(swell_lanes)(measured, weights, far, fairness, block);
}

} // namespace nendo::deform
#endif
