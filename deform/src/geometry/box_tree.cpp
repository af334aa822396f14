#include "geometry/box_tree.hpp"

#include <utility>

#include "geometry/octree_order.hpp"

namespace nendo::deform {
namespace {

constexpr std::uint32_t leaf_size = 8;

} // namespace

SpaceBox box_around(std::span<const SpacePoint> places, const Corners& triangle) noexcept {
  SpaceBox box{places[triangle[0]], places[triangle[0]]};
  for (std::size_t k = 1; k < 3; ++k)
    widen(box, {places[triangle[k]], places[triangle[k]]});
  return box;
}

BoxTree::BoxTree(std::span<const SpacePoint> places, std::span<const Corners> triangles)
    : BoxTree(places, triangles, all_indices(triangles.size())) {}

BoxTree::BoxTree(std::span<const SpacePoint> places, std::span<const Corners> triangles,
                 std::vector<std::uint32_t> chosen)
    : order_(std::move(chosen)) {
  build(places, triangles);
}

// Triangles are put in the order of an octree's leaves, and halved then: what is near in that order
// is near in space (C. Lauterbach and others, "Fast BVH Construction on GPUs", 2009).
void BoxTree::build(std::span<const SpacePoint> places, std::span<const Corners> triangles) {
  if (order_.empty()) return;
  std::vector<SpaceBox> unsorted;
  unsorted.reserve(order_.size());
  Points middles(3, static_cast<Eigen::Index>(order_.size()));
  for (const std::uint32_t triangle : order_) {
    const SpaceBox& box = unsorted.emplace_back(box_around(places, triangles[triangle]));
    const SpacePoint middle = 0.5 * (box.low + box.high);
    middles.col(static_cast<Eigen::Index>(unsorted.size()) - 1) << middle[0], middle[1], middle[2];
  }
  std::vector<std::uint32_t> sorted;
  boxes_.reserve(order_.size());
  sorted.reserve(order_.size());
  for (const std::uint32_t number : octree_order(middles)) {
    boxes_.push_back(unsorted[number]);
    sorted.push_back(order_[number]);
  }
  order_ = std::move(sorted);
  nodes_.reserve(order_.size());
  nodes_.push_back({});
  split(0, 0, to_index(order_.size()));
  for (std::size_t node = nodes_.size(); node-- > 0;) // children come after their node
    nodes_[node].box = box_of(nodes_[node]);
}

void BoxTree::split(std::uint32_t node, std::uint32_t begin, std::uint32_t count) {
  if (count <= leaf_size) {
    nodes_[node] = {{}, begin, count};
    return;
  }
  const auto first = to_index(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  nodes_[node] = {{}, first, 0};
  const std::uint32_t half = count / 2;
  split(first, begin, half);
  split(first + 1, begin + half, count - half);
}

SpaceBox BoxTree::box_of(const Node& node) const noexcept {
  const bool is_leaf = node.count > 0;
  SpaceBox box = is_leaf ? boxes_[node.first] : nodes_[node.first].box;
  for (std::uint32_t at = node.first + 1; at < node.first + (is_leaf ? node.count : 2); ++at)
    widen(box, is_leaf ? boxes_[at] : nodes_[at].box);
  return box;
}

} // namespace nendo::deform
