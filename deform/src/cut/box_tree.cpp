#include "cut/box_tree.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

namespace nendo::deform {
namespace {

constexpr std::uint32_t leaf_size = 8;

/// The place of a box's middle on the curve, and the box's number.
struct MortonKey {
  std::uint32_t code, number;
};

constexpr unsigned axis_bits = 10;

/// Puts two zeros behind each of the ten bits.
constexpr std::uint32_t spread(std::uint32_t bits) noexcept {
  bits = (bits | bits << 16U) & 0x030000FFU;
  bits = (bits | bits << 8U) & 0x0300F00FU;
  bits = (bits | bits << 4U) & 0x030C30C3U;
  return (bits | bits << 2U) & 0x09249249U;
}

/// Sorts by the codes, and equal ones by numbers.
void sort(std::vector<MortonKey>& keys) {
  std::vector<MortonKey> other(keys.size());
  constexpr std::size_t digits = std::size_t{1} << axis_bits;
  for (unsigned shift = 0; shift < 3 * axis_bits; shift += axis_bits) {
    const auto digit = [&](const MortonKey& key) { return key.code >> shift & (digits - 1); };
    std::array<std::uint32_t, digits + 1> begins{};
    for (const MortonKey& key : keys)
      ++begins[digit(key) + 1];
    std::partial_sum(begins.begin(), begins.end(), begins.begin());
    for (const MortonKey& key : keys)
      other[begins[digit(key)]++] = key;
    keys.swap(other);
  }
}

std::vector<MortonKey> sorted_keys(const std::vector<SpaceBox>& boxes) {
  SpaceBox whole = boxes.front();
  for (const SpaceBox& box : boxes)
    widen(whole, box);
  SpacePoint scale{};
  constexpr double most = (1U << axis_bits) - 1;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double size = whole.high[axis] - whole.low[axis];
    scale[axis] = size > 0.0 && std::isfinite(most / size) ? most / size : 0.0;
  }
  std::vector<MortonKey> keys;
  keys.reserve(boxes.size());
  for (const SpaceBox& box : boxes) {
    std::uint32_t code = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double middle = 0.5 * (box.low[axis] + box.high[axis]);
      const double part = (middle - whole.low[axis]) * scale[axis];
      const double cell = part > 0.0 ? std::min(part, most) : 0.0; // 0 of a NaN, too
      code |= spread(static_cast<std::uint32_t>(cell)) << axis;
    }
    keys.push_back({code, static_cast<std::uint32_t>(keys.size())});
  }
  sort(keys);
  return keys;
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

// Triangles are sorted along Morton's curve (G. M. Morton, 1966; C. Lauterbach and others, "Fast
// BVH Construction on GPUs", 2009), and halved then: what is near on the curve is near in space.
void BoxTree::build(std::span<const SpacePoint> places, std::span<const Corners> triangles) {
  if (order_.empty()) return;
  std::vector<SpaceBox> unsorted;
  unsorted.reserve(order_.size());
  for (const std::uint32_t triangle : order_)
    unsorted.push_back(box_around(places, triangles[triangle]));
  const std::vector<MortonKey> keys = sorted_keys(unsorted);
  std::vector<std::uint32_t> sorted;
  boxes_.reserve(keys.size());
  sorted.reserve(keys.size());
  for (const MortonKey& key : keys) {
    boxes_.push_back(unsorted[key.number]);
    sorted.push_back(order_[key.number]);
  }
  order_ = std::move(sorted);
  nodes_.reserve(order_.size());
  nodes_.push_back({});
  split(0, 0, static_cast<std::uint32_t>(order_.size()));
  for (std::size_t node = nodes_.size(); node-- > 0;) // children come behind
    nodes_[node].box = box_of(nodes_[node]);
}

void BoxTree::split(std::uint32_t node, std::uint32_t begin, std::uint32_t count) {
  if (count <= leaf_size) {
    nodes_[node] = {{}, begin, count};
    return;
  }
  const auto first = static_cast<std::uint32_t>(nodes_.size());
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
