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
  std::vector<Middle> middles;
  unsorted.reserve(order_.size());
  middles.reserve(order_.size());
  for (const std::uint32_t triangle : order_) {
    const auto number = static_cast<std::uint32_t>(unsorted.size());
    const SpaceBox& box = unsorted.emplace_back(box_around(places, triangles[triangle]));
    middles.push_back({0.5 * (box.low + box.high), number});
  }
  nodes_.reserve(order_.size());
  nodes_.push_back({});
  split(0, 0, middles);
  boxes_.reserve(unsorted.size());
  std::vector<std::uint32_t> sorted;
  sorted.reserve(order_.size());
  for (const Middle& middle : middles) {
    boxes_.push_back(unsorted[middle.number]);
    sorted.push_back(order_[middle.number]);
  }
  order_ = std::move(sorted);
  for (std::size_t node = nodes_.size(); node-- > 0;) // children come behind
    nodes_[node].box = box_of(nodes_[node]);
}

void BoxTree::split(std::uint32_t node, std::uint32_t begin, std::span<Middle> middles) {
  if (middles.size() <= leaf_size) {
    nodes_[node] = {{}, begin, static_cast<std::uint32_t>(middles.size())};
    return;
  }
  SpaceBox box{middles[0].at, middles[0].at};
  for (const Middle& middle : middles)
    widen(box, {middle.at, middle.at});
  const std::size_t axis = longest_axis(box);
  const std::size_t half = middles.size() / 2;
  std::nth_element(middles.begin(), middles.begin() + static_cast<std::ptrdiff_t>(half),
                   middles.end(), [axis](const Middle& a, const Middle& b) {
                     return a.at[axis] < b.at[axis] ||
                            (a.at[axis] == b.at[axis] && a.number < b.number);
                   });
  const auto first = static_cast<std::uint32_t>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node] = {{}, first, 0};
  split(first, begin, middles.first(half));
  split(first + 1, begin + static_cast<std::uint32_t>(half), middles.subspan(half));
}

SpaceBox BoxTree::box_of(const Node& node) const noexcept {
  const bool is_leaf = node.count > 0;
  SpaceBox box = is_leaf ? boxes_[node.first] : nodes_[node.first].box;
  for (std::uint32_t at = node.first + 1; at < node.first + (is_leaf ? node.count : 2); ++at)
    widen(box, is_leaf ? boxes_[at] : nodes_[at].box);
  return box;
}

} // namespace nendo::deform
