#include "clay/ring_layout.hpp"

#include <algorithm>
#include <array>
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

} // namespace nendo::deform
