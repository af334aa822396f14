#include "clay/volume_keeper.hpp"

#include <array>
#include <cstddef>
#include <cstring>
#include <utility>

#include "block_edit.hpp"

namespace nendo::deform {

namespace {

constexpr std::size_t calls_a_direction = 4;
// Of the directions, in the first call; one for a model so large that they would take several
// ticks.
constexpr int first_rounds = 4;
constexpr std::size_t most_blocks_for_all_rounds = 1024;
/// Of a step to the middle of the ring, for each edge that a vertex is moved by.
constexpr double fairness = 2.0;

/// A block's, about.
constexpr float edges_across = 8.0F;

/// Four coordinates in a register: one load takes a neighbour, where three would wait for three
/// cache lines.
using Four = float __attribute__((vector_size(16)));

void gather(const std::array<float, 4>* points, const std::uint32_t* places,
            VertexBlock& to) noexcept {
  const auto load = [&](std::size_t lane) {
    Four four;
    std::memcpy(&four, points[places[lane]].data(), sizeof(four));
    return four;
  };
  for (std::size_t lane = 0; lane < block_size; lane += 4) {
    const Four a = load(lane), b = load(lane + 1), c = load(lane + 2), d = load(lane + 3);
    const Four xy = __builtin_shufflevector(a, b, 0, 4, 1, 5);
    const Four xy2 = __builtin_shufflevector(c, d, 0, 4, 1, 5);
    const Four z = __builtin_shufflevector(a, b, 2, 6, 3, 7);
    const Four z2 = __builtin_shufflevector(c, d, 2, 6, 3, 7);
    const Four all_x = __builtin_shufflevector(xy, xy2, 0, 1, 4, 5);
    const Four all_y = __builtin_shufflevector(xy, xy2, 2, 3, 6, 7);
    const Four all_z = __builtin_shufflevector(z, z2, 0, 1, 4, 5);
    std::memcpy(to.x.data() + lane, &all_x, sizeof(Four));
    std::memcpy(to.y.data() + lane, &all_y, sizeof(Four));
    std::memcpy(to.z.data() + lane, &all_z, sizeof(Four));
  }
}

void scatter(const VertexBlock& from, std::array<float, 4>* to) noexcept {
  for (std::size_t lane = 0; lane < block_size; ++lane)
    to[lane] = {from.x[lane], from.y[lane], from.z[lane], 0.0F};
}

/// Each edge is run along once in each direction.
bool is_closed_surface(std::span<const std::uint32_t> corners, std::size_t vertices) {
  const auto edges = [&](bool ahead) {
    return rows_by_key<std::uint32_t>(vertices, [&](const auto& visit) {
      for (std::size_t at = 0; at < corners.size(); ++at) {
        const std::uint32_t next = corners[at % 3 == 2 ? at - 2 : at + 1];
        ahead ? visit(corners[at], next) : visit(next, corners[at]);
      }
    });
  };
  auto ahead = edges(true);
  auto back = edges(false);
  for (std::size_t vertex = 0; vertex < vertices; ++vertex) {
    std::sort(ahead[vertex].begin(), ahead[vertex].end());
    std::sort(back[vertex].begin(), back[vertex].end());
    if (!std::equal(ahead[vertex].begin(), ahead[vertex].end(), back[vertex].begin(),
                    back[vertex].end()) ||
        std::adjacent_find(ahead[vertex].begin(), ahead[vertex].end()) != ahead[vertex].end())
      return false;
  }
  return !corners.empty() && corners.size() % 3 == 0;
}

} // namespace

VolumeKeeper::VolumeKeeper(const BlockLayout& layout, std::span<const std::uint32_t> triangles)
    : vertices_(layout.vertex_count()), is_closed_(is_closed_surface(triangles, vertices_)) {
  if (!is_closed_) return;
  const std::size_t blocks = layout.block_count();
  const Fans fans = fans_of(layout, triangles);
  build_rings(fans, blocks);
  build_neighbours(fans, blocks);
  stamps_.assign(blocks, 0);
  facts_.assign(blocks, {});
  is_turned_.assign(blocks, 1);
  is_free_.assign(blocks, 0);
  points_.assign(blocks * block_size, {});
  directions_.assign(blocks * block_size, {});
  measured_.assign(blocks, RingBlock{});
  weights_.assign(blocks * block_size, 0.0F);
}

/// Orders the neighbours of each vertex as they are met when one goes round it, counter-clockwise.
/// Where several fans meet, each begins and ends with the same neighbour, so that the products of
/// neighbours in a row are still those of the triangles: what leads from fan to fan cancels out.
VolumeKeeper::Fans VolumeKeeper::fans_of(const BlockLayout& layout,
                                         std::span<const std::uint32_t> corners) const {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  const std::vector<std::uint32_t> places = layout.places();
  auto edges = rows_by_key<Edge>(vertices_, [&](const auto& visit) {
    for (std::size_t at = 0; at < corners.size(); ++at) {
      const std::size_t first = at / 3 * 3;
      visit(places[corners[at]],
            Edge{places[corners[first + (at + 1) % 3]], places[corners[first + (at + 2) % 3]]});
    }
  });
  Fans fans;
  fans.starts.assign(1, 0);
  for (std::size_t place = 0; place < vertices_; ++place) {
    const std::span<Edge> around = edges[place];
    std::size_t fan = 0; // its first edge
    for (std::size_t at = 0; at < around.size(); ++at) {
      fans.items.push_back(around[at].first);
      if (around[at].second == around[fan].first) { // round
        if (fan > 0 || at + 1 < around.size()) fans.items.push_back(around[fan].first);
        fan = at + 1;
        continue;
      }
      const auto next =
          std::find_if(around.begin() + static_cast<std::ptrdiff_t>(at) + 1, around.end(),
                       [&](const Edge& edge) { return edge.first == around[at].second; });
      if (next != around.end())
        std::iter_swap(around.begin() + static_cast<std::ptrdiff_t>(at) + 1, next);
    }
    fans.starts.push_back(static_cast<std::uint32_t>(fans.items.size()));
  }
  return fans;
}

void VolumeKeeper::build_rings(const Fans& fans, std::size_t blocks) {
  ring_counts_.assign(blocks * block_size, 0.0F);
  first_rings_.assign(1, 0);
  for (std::size_t block = 0; block < blocks; ++block) {
    std::size_t most = 0;
    for (std::size_t place = block * block_size; place < end_of(block); ++place) {
      most = std::max(most, fans[place].size());
      ring_counts_[place] = static_cast<float>(fans[place].size());
    }
    for (std::size_t at = 0; at < most; ++at)
      for (std::size_t place = block * block_size; place < (block + 1) * block_size; ++place) {
        const auto fan = place < vertices_ ? fans[place] : std::span<const std::uint32_t>{};
        const auto itself = static_cast<std::uint32_t>(std::min(place, vertices_ - 1));
        ring_neighbours_.push_back(fan.empty() ? itself : fan[std::min(at, fan.size() - 1)]);
      }
    first_rings_.push_back(ring_neighbours_.size());
    around_points_.resize(std::max(around_points_.size(), most));
  }
  around_directions_.resize(around_points_.size());
}

/// The neighbours are brought together one by one: many processors' gathering loads take longer.
void VolumeKeeper::measure(const BoundedShape& shape, std::size_t block, bool turns) noexcept {
  const std::uint32_t* const from = ring_neighbours_.data() + first_rings_[block];
  const std::size_t most = (first_rings_[block + 1] - first_rings_[block]) / block_size;
  for (std::size_t at = 0; at < most; ++at) {
    gather(points_.data(), from + at * block_size, around_points_[at]);
    if (turns) gather(directions_.data(), from + at * block_size, around_directions_[at]);
  }
  measure_rings(shape.shape[block],
                {{around_points_.data(), most},
                 {around_directions_.data(), turns ? most : 0},
                 ring_counts_.data() + block * block_size},
                is_turned_[block] != 0, measured_[block], facts_[block]);
  is_turned_[block] = turns ? 1 : 0;
  if (turns) scatter(measured_[block].direction, directions_.data() + block * block_size);
}

void VolumeKeeper::build_neighbours(const Fans& fans, std::size_t blocks) {
  neighbours_.starts.assign(1, 0);
  std::vector<std::uint32_t> of_block;
  for (std::size_t block = 0; block < blocks; ++block) {
    of_block.assign(1, static_cast<std::uint32_t>(block));
    for (std::size_t place = block * block_size; place < end_of(block); ++place)
      for (const std::uint32_t other : fans[place])
        of_block.push_back(static_cast<std::uint32_t>(other / block_size));
    std::sort(of_block.begin(), of_block.end());
    of_block.erase(std::unique(of_block.begin(), of_block.end()), of_block.end());
    neighbours_.items.insert(neighbours_.items.end(), of_block.begin(), of_block.end());
    neighbours_.starts.push_back(static_cast<std::uint32_t>(neighbours_.items.size()));
  }
}

bool VolumeKeeper::has_changed(const BoundedShape& shape, std::size_t block) const noexcept {
  const auto around = neighbours_[block];
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t other) {
    return stamps_[other] != shape.shape.stamp(other);
  });
}

/// In which directions a shape swells need not be known to the last call: a block's are found anew
/// in one of some calls. The first call, which knows none, goes round some times.
double VolumeKeeper::volume(const BoundedShape& shape) noexcept {
  for (std::size_t block = 0; block < facts_.size(); ++block)
    if (stamps_[block] != shape.shape.stamp(block))
      scatter(shape.shape[block], points_.data() + block * block_size);
  const int rounds = facts_.size() <= most_blocks_for_all_rounds ? first_rounds : 1;
  for (int round = 0; calls_ == 0 && round < rounds; ++round)
    for (std::size_t block = 0; block < facts_.size(); ++block)
      measure(shape, block, true);
  ++calls_;
  double sum = 0.0;
  for (std::size_t block = 0; block < facts_.size(); ++block) {
    if (has_changed(shape, block)) measure(shape, block, (block + calls_) % calls_a_direction == 0);
    sum += facts_[block].volume;
  }
  for (std::size_t block = 0; block < facts_.size(); ++block)
    stamps_[block] = shape.shape.stamp(block);
  return sum;
}

void VolumeKeeper::forget() noexcept {
  std::fill(stamps_.begin(), stamps_.end(), 0);
  std::fill(directions_.begin(), directions_.end(), std::array<float, 4>{});
  std::fill(is_turned_.begin(), is_turned_.end(), std::uint8_t{1});
  calls_ = 0;
}

/// By the distance from the box along the farthest axis, and by that from the bodies.
void VolumeKeeper::weigh(const BoundedShape& shape, ContactSearch& search,
                         const GiveBack& how) noexcept {
  const auto reach = static_cast<float>(how.reach);
  for (std::size_t block = 0; block < facts_.size(); ++block) {
    const bool is_reached = how.around == nullptr || how.around->meets(shape.bounds[block], reach);
    is_free_[block] = is_reached ? 1 : 0;
    if (!is_reached) continue;
    float* const weights = weights_.data() + block * block_size;
    if (how.around == nullptr)
      std::fill_n(weights, block_size, 1.0F);
    else
      weigh_around_box(shape.shape[block], how.around->limits, reach, weights);
  }
  const auto near = static_cast<float>(how.near);
  for (std::size_t body = 0; body < search.bodies(); ++body)
    search.each_near(shape, body, how.near, [&](std::size_t block, const NearestLanes& nearest) {
      hold_near_body(nearest.distance.data(), near, weights_.data() + block * block_size);
    });
}

/// How much volume a step along the weighted directions adds.
void VolumeKeeper::sum_rates() noexcept {
  rate_ = bend_ = 0.0;
  for (std::size_t block = 0; block < facts_.size(); ++block) {
    if (is_free_[block] == 0) continue;
    const SwellRates rates = swell_rates(measured_[block], weights_.data() + block * block_size);
    rate_ += rates.rate;
    bend_ += rates.bend;
    is_free_[block] = rates.is_free ? 1 : 0;
  }
}

/// Solves rate * far + bend * far^2 = missing near far = 0.
double VolumeKeeper::distance_for(double missing, double most) const noexcept {
  double far = std::clamp(missing / rate_, -most, most);
  for (int round = 0; round < 3; ++round) {
    const double rate = std::max(rate_ + bend_ * far, 0.5 * rate_);
    far = std::clamp(missing / rate, -most, most);
  }
  return far;
}

/// Besides, each vertex goes a part of the way to the middle of its neighbours, which keeps
/// triangles fair where much swells, and fills creases. Returns by how much that makes the volume
/// grow.
double VolumeKeeper::swell(BoundedShape& shape, double far, double fairs) noexcept {
  double grown = 0.0;
  for (std::size_t block = 0; block < facts_.size(); ++block)
    if (is_free_[block] != 0) {
      const Swelling swelling = swell_block(measured_[block], weights_.data() + block * block_size,
                                            static_cast<float>(far), static_cast<float>(fairs),
                                            shape.shape.data()[block]);
      grown += swelling.grown;
      RingFacts& facts = facts_[block];
      facts.may_turn = facts.may_turn || swelling.spread / edges_across + 2.0F * swelling.aside >
                                             0.5F * facts.least_height;
    }
  return grown;
}

/// After all steps of the blocks that swell.
void VolumeKeeper::finish_blocks(BoundedShape& shape) noexcept {
  const std::uint64_t stamp = BlockShape::new_stamp();
  for (std::size_t block = 0; block < facts_.size(); ++block) {
    if (is_free_[block] == 0) continue;
    VertexBlock& content = shape.shape.data()[block];
    repeat_last(content, end_of(block) - block * block_size);
    shape.shape.set_stamp(block, stamp);
    shape.bounds[block] = fast_bounds_of(content);
  }
}

double VolumeKeeper::give_back(BoundedShape& shape, ContactSearch& search, double missing,
                               const GiveBack& how) noexcept {
  weigh(shape, search, how);
  sum_rates();
  if (!(rate_ > 0.0)) return 0.0;
  const double far = distance_for(missing, how.most);
  const double by_fairing = swell(shape, far, fairness * std::abs(far));
  const double rest = std::clamp(-by_fairing / rate_, -how.most, how.most);
  if (rest != 0.0) swell(shape, rest, 0.0);
  finish_blocks(shape);
  shape.extent += 2.0 * how.most;
  return (rate_ + bend_ * far) * far + by_fairing + rate_ * rest;
}

} // namespace nendo::deform
