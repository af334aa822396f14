#include "clay/volume_keeper.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <utility>

namespace nendo::deform {

namespace {

/// Orders the neighbours of each vertex as they are met when one goes round it, counter-clockwise.
/// Where several fans meet, each begins and ends with the same neighbour, so that the products of
/// neighbours in a row are still those of the triangles: what leads from fan to fan cancels out.
RowsByKey<std::uint32_t> fans_of(const BlockLayout& layout,
                                 std::span<const std::uint32_t> corners) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  const std::vector<std::uint32_t> places = layout.places();
  auto edges = rows_by_key<Edge>(places.size(), [&](const auto& visit) {
    for (std::size_t at = 0; at < corners.size(); ++at) {
      const std::size_t first = at / 3 * 3;
      visit(places[corners[at]],
            Edge{places[corners[first + (at + 1) % 3]], places[corners[first + (at + 2) % 3]]});
    }
  });
  RowsByKey<std::uint32_t> fans;
  fans.starts.assign(1, 0);
  for (std::size_t place = 0; place < places.size(); ++place) {
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

constexpr std::size_t calls_per_direction = 4;
// Of the directions, in the first call; one for a model so large that they would take several
// ticks.
constexpr int first_rounds = 4;
constexpr std::size_t max_blocks_for_all_rounds = 1024;
/// Of a step to the middle of the ring, for each edge that a vertex is moved by.
constexpr double fairness = 2.0;

/// A block's, about.
constexpr float edges_across = 8.0F;

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

RingLayout::RingLayout(const BlockLayout& layout, std::span<const std::uint32_t> triangles)
    : vertices_(layout.vertex_count()) {
  const std::size_t blocks = layout.block_count();
  const Fans fans = fans_of(layout, triangles);
  counts_.assign(blocks * block_size, 0.0F);
  first_parts_.assign(1, 0);
  for (std::size_t block = 0; block < blocks; ++block)
    add_block(fans, block);
  begin_part();
  list_blocks_around(fans, blocks);
}

/// A vertex that has fewer neighbours than others repeats its last one; one that has none, itself.
void RingLayout::add_block(const Fans& fans, std::size_t block) {
  const std::size_t first = block * block_size;
  std::size_t most = 0;
  for (std::size_t place = first; place < std::min(vertices_, first + block_size); ++place) {
    most = std::max(most, fans[place].size());
    counts_[place] = static_cast<float>(fans[place].size());
  }
  std::array<std::uint32_t, block_size> neighbours;
  for (std::size_t row = 0; row < most; ++row) {
    for (std::size_t lane = 0; lane < block_size; ++lane) {
      const std::size_t place = first + lane;
      const auto fan = place < vertices_ ? fans[place] : std::span<const std::uint32_t>{};
      const auto itself = static_cast<std::uint32_t>(std::min(place, vertices_ - 1));
      neighbours[lane] = fan.empty() ? itself : fan[std::min(row, fan.size() - 1)];
    }
    if (row > 0 && add_row(block, neighbours)) continue;
    begin_part();
    add_row(block, neighbours);
  }
  max_parts_ = std::max(max_parts_, parts_.size() - first_parts_.back());
  first_parts_.push_back(static_cast<std::uint32_t>(parts_.size()));
}

void RingLayout::begin_part() {
  parts_.push_back(
      {static_cast<std::uint32_t>(rows_.size()), static_cast<std::uint32_t>(far_.size())});
}

/// Adds the row to the last part. Returns false if the row's places do not fit in its table.
bool RingLayout::add_row(std::size_t block, std::span<const std::uint32_t> neighbours) {
  const std::size_t first = block * block_size;
  const std::size_t far_before = far_.size();
  RingRow row;
  for (std::size_t lane = 0; lane < block_size; ++lane) {
    const std::uint32_t place = neighbours[lane];
    std::size_t number = place - first; // huge where the place is before the block
    if (number >= block_size) {
      const auto begin = far_.begin() + parts_.back().first_far;
      const auto found = std::find(begin, far_.end(), place);
      number = block_size + static_cast<std::size_t>(found - begin);
      if (found == far_.end()) far_.push_back(place);
    }
    if (number >= std::tuple_size_v<RingTable>) {
      far_.resize(far_before);
      return false;
    }
    row[lane] = static_cast<std::uint8_t>(number);
  }
  rows_.push_back(row);
  return true;
}

void RingLayout::list_blocks_around(const Fans& fans, std::size_t blocks) {
  blocks_around_.starts.assign(1, 0);
  std::vector<std::uint32_t> around;
  for (std::size_t block = 0; block < blocks; ++block) {
    around.assign(1, static_cast<std::uint32_t>(block));
    const std::size_t first = block * block_size;
    for (std::size_t place = first; place < std::min(vertices_, first + block_size); ++place)
      for (const std::uint32_t other : fans[place])
        around.push_back(static_cast<std::uint32_t>(other / block_size));
    std::sort(around.begin(), around.end());
    around.erase(std::unique(around.begin(), around.end()), around.end());
    blocks_around_.items.insert(blocks_around_.items.end(), around.begin(), around.end());
    blocks_around_.starts.push_back(static_cast<std::uint32_t>(blocks_around_.items.size()));
  }
}

VolumeKeeper::VolumeKeeper(const BlockLayout& layout, std::span<const std::uint32_t> triangles)
    : vertices_(layout.vertex_count()) {
  if (!is_closed_surface(triangles, vertices_)) return;
  const std::size_t blocks = layout.block_count();
  ring_layout_.emplace(layout, triangles);
  stamps_.assign(blocks, 0);
  facts_.assign(blocks, {});
  is_turned_.assign(blocks, 1);
  is_free_.assign(blocks, 0);
  measured_.assign(blocks, RingBlock{});
  weights_.assign(blocks * block_size, 0.0F);
  points_.resize(ring_layout_->max_parts());
  directions_.resize(points_.size());
  parts_.resize(points_.size());
}

void VolumeKeeper::measure(const BoundedShape& shape, std::size_t block, bool turns) noexcept {
  const std::size_t parts = ring_layout_->parts(block);
  for (std::size_t part = 0; part < parts; ++part) {
    ring_layout_->fill(
        block, part, [&](std::size_t of) -> const VertexBlock& { return shape.shape[of]; },
        points_[part]);
    if (turns)
      ring_layout_->fill(
          block, part,
          [&](std::size_t of) -> const VertexBlock& { return measured_[of].direction; },
          directions_[part]);
    parts_[part] = {ring_layout_->rows(block, part), &points_[part],
                    turns ? &directions_[part] : nullptr};
  }
  measure_rings(shape.shape[block], {{parts_.data(), parts}, ring_layout_->counts(block)},
                is_turned_[block] != 0, measured_[block], facts_[block]);
  is_turned_[block] = turns ? 1 : 0;
}

bool VolumeKeeper::has_changed(const BoundedShape& shape, std::size_t block) const noexcept {
  const auto around = ring_layout_->blocks_around(block);
  return std::any_of(around.begin(), around.end(), [&](std::uint32_t other) {
    return stamps_[other] != shape.shape.stamp(other);
  });
}

/// In which directions a shape swells need not be known to the last call: a block's are found again
/// in one of some calls. The first call, which knows none, goes round some times.
double VolumeKeeper::volume(const BoundedShape& shape) noexcept {
  const int rounds = facts_.size() <= max_blocks_for_all_rounds ? first_rounds : 1;
  for (int round = 0; calls_ == 0 && round < rounds; ++round)
    for (std::size_t block = 0; block < facts_.size(); ++block)
      measure(shape, block, true);
  ++calls_;
  double sum = 0.0;
  for (std::size_t block = 0; block < facts_.size(); ++block) {
    if (has_changed(shape, block))
      measure(shape, block, (block + calls_) % calls_per_direction == 0);
    sum += facts_[block].volume;
  }
  for (std::size_t block = 0; block < facts_.size(); ++block)
    stamps_[block] = shape.shape.stamp(block);
  return sum;
}

void VolumeKeeper::forget() noexcept {
  std::fill(stamps_.begin(), stamps_.end(), 0);
  for (RingBlock& measured : measured_)
    measured.direction = VertexBlock{};
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
                                             0.5F * facts.min_height;
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
