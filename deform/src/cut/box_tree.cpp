#include "cut/box_tree.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

namespace nendo::deform {
namespace {

constexpr std::uint32_t leaf_size = 4;

std::size_t longest_axis(const SpaceBox& box) noexcept {
  const SpacePoint size = box.high - box.low;
  return static_cast<std::size_t>(std::max_element(size.begin(), size.end()) - size.begin());
}

std::vector<std::uint32_t> counted(std::size_t count) {
  std::vector<std::uint32_t> all(count);
  std::iota(all.begin(), all.end(), 0u);
  return all;
}

} // namespace

void widen(SpaceBox& box, const SpaceBox& by) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], by.low[axis]);
    box.high[axis] = std::max(box.high[axis], by.high[axis]);
  }
}

SpaceBox box_around(std::span<const SpacePoint> places, const Corners& triangle) noexcept {
  SpaceBox box{places[triangle[0]], places[triangle[0]]};
  for (std::size_t k = 1; k < 3; ++k)
    widen(box, {places[triangle[k]], places[triangle[k]]});
  return box;
}

BoxTree::BoxTree(std::span<const SpacePoint> places, std::span<const Corners> triangles)
    : BoxTree(places, triangles, counted(triangles.size())) {}

BoxTree::BoxTree(std::span<const SpacePoint> places, std::span<const Corners> triangles,
                 std::vector<std::uint32_t> chosen)
    : order_(std::move(chosen)) {
  build(places, triangles);
}

void BoxTree::build(std::span<const SpacePoint> places, std::span<const Corners> triangles) {
  if (order_.empty()) return;
  std::vector<SpaceBox> unsorted;
  std::vector<SpacePoint> middles; // in the order of `chosen`
  unsorted.reserve(order_.size());
  middles.reserve(order_.size());
  for (const std::uint32_t triangle : order_) {
    unsorted.push_back(box_around(places, triangles[triangle]));
    middles.push_back(0.5 * (unsorted.back().low + unsorted.back().high));
  }
  const std::vector<std::uint32_t> chosen = std::exchange(order_, counted(order_.size()));
  boxes_ = std::move(unsorted);
  nodes_.reserve(order_.size());
  nodes_.push_back({});
  split(0, 0, static_cast<std::uint32_t>(order_.size()), middles);
  std::vector<SpaceBox> sorted;
  sorted.reserve(boxes_.size());
  for (std::uint32_t& at : order_) {
    sorted.push_back(boxes_[at]);
    at = chosen[at];
  }
  boxes_ = std::move(sorted);
}

void BoxTree::split(std::uint32_t node, std::uint32_t begin, std::uint32_t end,
                    std::vector<SpacePoint>& middles) {
  SpaceBox box = boxes_[order_[begin]];
  SpaceBox of_middles{middles[order_[begin]], middles[order_[begin]]};
  for (std::uint32_t at = begin + 1; at < end; ++at) {
    widen(box, boxes_[order_[at]]);
    widen(of_middles, {middles[order_[at]], middles[order_[at]]});
  }
  if (end - begin <= leaf_size) {
    nodes_[node] = {box, begin, end - begin};
    return;
  }
  const std::size_t axis = longest_axis(of_middles);
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t a, std::uint32_t b) {
                     return middles[a][axis] < middles[b][axis] ||
                            (middles[a][axis] == middles[b][axis] && a < b);
                   });
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node] = {box, first, 0};
  split(first, begin, middle, middles);
  split(first + 1, middle, end, middles);
}

} // namespace nendo::deform
