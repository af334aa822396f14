#include "clay/volume_keeper.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace nendo::deform {

namespace {

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
    shape.bounds[block] = bounds_of(content);
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
