#include "clay/face_meetings.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstring>
#include <limits>

#include "geometry/triangle_meeting.hpp"
#include "simd/contact_kernels.hpp"

namespace nendo::deform {
namespace {

/// Faces of two blocks whose directions are within this angle do not look at each other. For a
/// surface without wrinkles that could be half a turn. At 2.8, wrinkles of a ball that is torn met
/// unseen; at 2.2, no longer.
constexpr float widest_cosine = -0.4161468F, widest_sine = 0.9092974F; // of the angle 2.0
constexpr std::size_t pairs_per_block = 64;
constexpr std::size_t max_met = 4096;
constexpr std::size_t max_tests = 50'000;    // of two triangles
constexpr std::size_t max_boxes = 8'000'000; // compared with others

using ThreePlaces = std::array<Eigen::Vector3f, 3>;

ThreePlaces places_of(const BlockShape& shape, const Corners& corners) noexcept {
  return {vertex_at(shape, corners[0]), vertex_at(shape, corners[1]), vertex_at(shape, corners[2])};
}

/// Certainly on one side of the plane of three corners.
bool is_parted(const ThreePlaces& plane, const ThreePlaces& of) noexcept {
  const Eigen::Vector3d from = plane[0].cast<double>();
  const Eigen::Vector3d a = plane[1].cast<double>() - from;
  const Eigen::Vector3d b = plane[2].cast<double>() - from;
  const Eigen::Vector3d normal = a.cross(b);
  const double least = 1e-12 * normal.lpNorm<1>();
  double low = 1e300, high = -1e300;
  for (const Eigen::Vector3f& corner : of) {
    const double height = normal.dot(corner.cast<double>() - from);
    low = std::min(low, height);
    high = std::max(high, height);
  }
  return low > least || high < -least;
}

Eigen::Vector3f normal_of(const BlockShape& shape, const Corners& corners) noexcept {
  const ThreePlaces at = places_of(shape, corners);
  return (at[1] - at[0]).cross(at[2] - at[0]);
}

bool looks_away(const Eigen::Vector3f& normal, const Eigen::Vector3f& way) noexcept {
  return !(normal.x() * way.x() + normal.y() * way.y() + normal.z() * way.z() > 0.0F);
}

/// Returns whether the angle between the axes, and those around both, are together wider. Cosines
/// and sines of sums show it without the angles, which would take longer.
bool may_face(const RingFacts& one, const RingFacts& other) noexcept {
  const float cosine = one.min_cosine * other.min_cosine - one.sine * other.sine;
  const float sine = one.sine * other.min_cosine + one.min_cosine * other.sine;
  if (sine < 0.0F || cosine < widest_cosine) return true; // those around both suffice
  const float between =
      one.axis[0] * other.axis[0] + one.axis[1] * other.axis[1] + one.axis[2] * other.axis[2];
  return between < widest_cosine * cosine + widest_sine * sine;
}

constexpr BlockBounds no_bounds{{1e30F, 1e30F, 1e30F, 0.0F, 1e30F, 1e30F, 1e30F, 0.0F}};

void extend(BlockBounds& box, const BlockBounds& by) noexcept {
  for (std::size_t side = 0; side < 8; ++side)
    box.sides[side] = std::min(box.sides[side], by.sides[side]);
}

/// Two registers of four sides each, without branches, which would be predicted badly.
bool overlap(const BlockBounds& a, const BlockBounds& b) noexcept {
  using Four = float __attribute__((vector_size(16)));
  using Two = std::uint64_t __attribute__((vector_size(16)));
  const auto half = [](const BlockBounds& box, std::size_t first) {
    Four four;
    std::memcpy(&four, box.sides.data() + first, sizeof(four));
    return four;
  };
  const auto is_gap = (half(a, 0) + half(b, 4) > 0.0F) | (half(a, 4) + half(b, 0) > 0.0F);
  const auto both = std::bit_cast<Two>(is_gap);
  return (both[0] | both[1]) == 0;
}

} // namespace

FaceMeetings::FaceMeetings(const BlockLayout& layout, std::span<const std::uint32_t> triangles)
    : boxed_(layout.block_count()), uneven_(layout.vertex_count()),
      gone_round_(layout.vertex_count()), around_(triangles.size() / 3) {
  const std::size_t blocks = layout.block_count();
  const std::vector<std::uint32_t> places = layout.places();
  auto of_block = rows_by_key<Corners>(blocks, [&](const auto& visit) {
    for (std::size_t at = 0; at + 2 < triangles.size(); at += 3) {
      const Corners corners{places[triangles[at]], places[triangles[at + 1]],
                            places[triangles[at + 2]]};
      visit(block_of(corners), corners);
    }
  });
  corners_ = std::move(of_block.items);
  first_triangles_ = std::move(of_block.starts);
  triangles_at_ = rows_by_key<std::uint32_t>(layout.vertex_count(), [&](const auto& visit) {
    for (std::size_t at = 0; at < corners_.size(); ++at)
      for (const std::uint32_t corner : corners_[at])
        visit(corner, static_cast<std::uint32_t>(at));
  });
  order_by_x(layout);
  std::size_t most = 0; // triangles of a block
  for (std::size_t block = 0; block < blocks; ++block)
    most = std::max<std::size_t>(most, first_triangles_[block + 1] - first_triangles_[block]);
  boxes_.resize(blocks);
  for (std::vector<float>& row : rows_) // beyond the last box, there is none to overlap
    row.assign(blocks + 2 * block_size, std::numeric_limits<float>::infinity());
  hulls_.resize(blocks);
  triangle_boxes_.resize(corners_.size());
  pairs_.reserve(pairs_per_block * blocks);
  is_folded_.assign(blocks, 0);
  some_.reserve(most);
  others_.reserve(most);
  near_.reserve(blocks);
  met_.reserve(max_met);
}

/// Each call then finds them nearly sorted.
void FaceMeetings::order_by_x(const BlockLayout& layout) {
  std::vector<double> lows(layout.block_count(), std::numeric_limits<double>::infinity());
  for (std::size_t place = 0; place < layout.vertex_count(); ++place) {
    double& low = lows[place / block_size];
    low = std::min(low, layout.original()(0, layout.order()[place]));
  }
  order_ = all_indices(lows.size());
  std::sort(order_.begin(), order_.end(),
            [&](std::uint32_t one, std::uint32_t other) { return lows[one] < lows[other]; });
}

std::uint32_t FaceMeetings::block_of(const Corners& corners) noexcept {
  return *std::min_element(corners.begin(), corners.end()) / block_size;
}

bool FaceMeetings::is_given_up() const noexcept {
  return is_crowded_ || tests_ > max_tests || boxes_compared_ > max_boxes || met_.size() == max_met;
}

void FaceMeetings::find(const BoundedShape& shape, const BlockShape& before,
                        const VolumeKeeper& volume) noexcept {
  begin(shape, volume);
  list_pairs(shape.shape, before, volume.facts());
  std::erase_if(pairs_, [&](const BlockPair& pair) {
    measure_boxes(shape.shape, pair.first);
    measure_boxes(shape.shape, pair.second);
    return !overlap(hulls_[pair.first], hulls_[pair.second]);
  });
  for (const BlockPair& pair : pairs_)
    if (!is_given_up()) search(pair, shape.shape, before);
}

void FaceMeetings::begin(const BoundedShape& shape, const VolumeKeeper& volume) noexcept {
  tests_ = boxes_compared_ = 0;
  met_.clear();
  boxed_.clear();
  rings_ = volume.rings();
  uneven_.clear();
  gone_round_.clear();
  const std::span<const RingFacts> facts = volume.facts();
  for (std::uint32_t block = 0; block < boxes_.size(); ++block) {
    boxes_[block] = shape.bounds[block];
    for (const std::size_t side : {0U, 1U, 2U, 4U, 5U, 6U})
      boxes_[block].sides[side] -= facts[block].longest_edge;
    is_folded_[block] = facts[block].is_even ? 0 : 1;
    if (facts[block].may_turn && has_face_away(shape.shape, block)) is_folded_[block] = 1;
  }
}

/// Sorts and sweeps along x. The order depends on the shape alone.
void FaceMeetings::list_pairs(const BlockShape& shape, const BlockShape& before,
                              std::span<const RingFacts> facts) noexcept {
  const auto is_before = [&](std::uint32_t one, std::uint32_t other) {
    const float x = boxes_[one].sides[0], other_x = boxes_[other].sides[0];
    return x < other_x || (x == other_x && one < other);
  };
  for (std::size_t at = 1; at < order_.size(); ++at) // nearly sorted since the last call
    for (std::size_t to = at; to > 0 && is_before(order_[to], order_[to - 1]); --to)
      std::swap(order_[to], order_[to - 1]);
  for (std::size_t at = 0; at < order_.size(); ++at)
    for (std::size_t row = 0; row < rows_.size(); ++row)
      rows_[row][at] = boxes_[order_[at]].sides[row < 3 ? row : row + 2];
  const BoxRows rows{rows_[0].data(), rows_[1].data(), rows_[2].data(), rows_[3].data(),
                     rows_[4].data()};
  const auto has_moved = [&](std::uint32_t block) {
    return shape.stamp(block) != before.stamp(block);
  };
  pairs_.clear();
  is_crowded_ = false;
  for (std::size_t at = 0; at < order_.size(); ++at) {
    const std::uint32_t one = order_[at];
    const BlockBounds& box = boxes_[one];
    for (std::size_t first = at; rows[0][first] <= -box.sides[4]; first += block_size)
      for (std::uint64_t left = boxes_in_way(rows, first, box.sides); left != 0; left &= left - 1) {
        const std::uint32_t other =
            order_[first + static_cast<std::size_t>(std::countr_zero(left))];
        if (!(has_moved(one) || has_moved(other)) ||
            !(is_folded_[one] != 0 || is_folded_[other] != 0 || may_face(facts[one], facts[other])))
          continue;
        is_crowded_ = pairs_.size() == pairs_.capacity();
        if (is_crowded_) return;
        pairs_.emplace_back(one, other);
      }
  }
}

/// In which the vertex there swells.
Eigen::Vector3f FaceMeetings::direction_at(std::uint32_t place) const noexcept {
  return vertex_in(rings_[place / block_size].direction, place % block_size);
}

/// Returns whether some face of the block looks away from the direction of one of its vertices.
bool FaceMeetings::has_face_away(const BlockShape& shape, std::uint32_t block) const noexcept {
  for (Triangle at = first_triangles_[block]; at < first_triangles_[block + 1]; ++at) {
    const Eigen::Vector3f normal = normal_of(shape, corners_[at]);
    for (const std::uint32_t corner : corners_[at])
      if (looks_away(normal, direction_at(corner))) return true;
  }
  return false;
}

BlockBounds FaceMeetings::box_of(const BlockShape& shape, Triangle triangle) const noexcept {
  const ThreePlaces at = places_of(shape, corners_[triangle]);
  BlockBounds box{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto row = static_cast<Eigen::Index>(axis);
    box.sides[axis] = std::min({at[0][row], at[1][row], at[2][row]});
    box.sides[axis + 4] = -std::max({at[0][row], at[1][row], at[2][row]});
  }
  return box;
}

/// The boxes of a block's triangles, and the box of them all, once a call.
void FaceMeetings::measure_boxes(const BlockShape& shape, std::uint32_t block) noexcept {
  if (!boxed_.add(block)) return;
  hulls_[block] = no_bounds;
  for (Triangle at = first_triangles_[block]; at < first_triangles_[block + 1]; ++at) {
    triangle_boxes_[at] = box_of(shape, at);
    extend(hulls_[block], triangle_boxes_[at]);
  }
}

/// Where all faces around a vertex look to one side, none of them meet. All: those that belong to
/// other blocks, which may not have been examined.
bool FaceMeetings::is_uneven(const BlockShape& shape, std::uint32_t place) noexcept {
  if (!gone_round_.add(place)) return uneven_.has(place);
  for (const Triangle at : triangles_at_[place])
    if (looks_away(normal_of(shape, corners_[at]), direction_at(place))) {
      uneven_.add(place);
      return true;
    }
  return false;
}

void FaceMeetings::search(BlockPair blocks, const BlockShape& shape,
                          const BlockShape& before) noexcept {
  const auto [first, second] = blocks;
  const auto collect = [&](std::uint32_t block, const BlockBounds& near,
                           std::vector<Triangle>& to) {
    to.clear();
    for (Triangle at = first_triangles_[block]; at < first_triangles_[block + 1]; ++at)
      if (overlap(triangle_boxes_[at], near)) to.push_back(at);
  };
  collect(first, hulls_[second], some_);
  if (some_.empty()) return;
  collect(second, hulls_[first], others_);
  boxes_compared_ += some_.size() * others_.size();
  const auto is_even_between = [&](Triangle one, Triangle other) {
    for (const std::uint32_t corner : corners_[one])
      for (const std::uint32_t of : corners_[other])
        if (corner == of && !is_uneven(shape, corner)) return true;
    return false;
  };
  for (const Triangle one : some_)
    for (const Triangle other : others_)
      if ((first != second || one < other) &&
          overlap(triangle_boxes_[one], triangle_boxes_[other]) && !is_even_between(one, other))
        test(one, other, shape, before);
}

/// All of these faces with all others, whatever they look at.
void FaceMeetings::find_at(std::span<const std::uint32_t> places, const BlockShape& shape,
                           const BlockShape& before) noexcept {
  met_.clear();
  around_.clear();
  for (const std::uint32_t place : places)
    for (const Triangle triangle : triangles_at_[place])
      around_.add(triangle);
  BlockBounds whole = no_bounds;
  for (const Triangle one : around_.members()) {
    const std::uint32_t block = block_of(corners_[one]);
    measure_boxes(shape, block);
    triangle_boxes_[one] = box_of(shape, one);
    extend(hulls_[block], triangle_boxes_[one]);
    extend(boxes_[block], triangle_boxes_[one]);
    extend(whole, triangle_boxes_[one]);
  }
  near_.clear();
  for (std::uint32_t block = 0; block < boxes_.size(); ++block)
    if (overlap(whole, boxes_[block])) {
      measure_boxes(shape, block);
      near_.push_back(block);
    }
  for (const Triangle one : around_.members()) {
    const BlockBounds& box = triangle_boxes_[one];
    boxes_compared_ += near_.size();
    if (is_given_up()) return;
    for (const std::uint32_t block : near_) {
      if (!overlap(box, hulls_[block])) continue;
      boxes_compared_ += first_triangles_[block + 1] - first_triangles_[block];
      for (Triangle other = first_triangles_[block]; other < first_triangles_[block + 1]; ++other)
        if (overlap(box, triangle_boxes_[other]) && (!around_.has(other) || one < other))
          test(one, other, shape, before);
    }
  }
}

void FaceMeetings::test(Triangle one, Triangle other, const BlockShape& shape,
                        const BlockShape& before) noexcept {
  if (is_given_up()) return;
  ++tests_;
  const Corners& a = corners_[one];
  const Corners& b = corners_[other];
  if (std::find_first_of(a.begin(), a.end(), b.begin(), b.end()) == a.end()) { // nothing shared
    const ThreePlaces at = places_of(shape, a);
    const ThreePlaces of = places_of(shape, b);
    if (is_parted(at, of) || is_parted(of, at)) return;
  }
  if (meet(shape, one, other) && !meet(before, one, other)) met_.emplace_back(one, other);
}

/// Decided exactly.
bool FaceMeetings::meet(const BlockShape& shape, Triangle one, Triangle other) const noexcept {
  std::array<SpacePoint, 6> points{};
  std::array<std::uint32_t, 6> places{};
  std::uint32_t count = 0;
  const auto numbered = [&](const Corners& corners) {
    Corners numbers{};
    for (std::size_t k = 0; k < 3; ++k) {
      const auto* const end = places.cbegin() + count;
      const auto* const found = std::find(places.cbegin(), end, corners[k]);
      numbers[k] = static_cast<std::uint32_t>(found - places.cbegin());
      if (found != end) continue;
      const Eigen::Vector3d at = vertex_at(shape, corners[k]).cast<double>();
      points[count] = {at.x(), at.y(), at.z()};
      places[count++] = corners[k];
    }
    return numbers;
  };
  const Corners first = numbered(corners_[one]);
  const Corners second = numbered(corners_[other]);
  return triangles_meet(points, first, second);
}

} // namespace nendo::deform
