#include <nendo/deform/vertex_blocks.hpp>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <tuple>
#include <utility>

#include "simd/field_kernels.hpp"

namespace nendo::deform {

namespace {

/// Enough of a place to choose neighbours by, which is not to be fetched from afar.
struct Place {
  Eigen::Vector3f at;
  std::uint32_t index;
};
using PlaceIterator = std::vector<Place>::iterator;

/// In shares of the model's largest side: numbers that float holds.
std::vector<Place> places_of(const Points& points) {
  const auto [lowest, highest] = finite_box_of(points);
  const double half = (highest / 2.0 - lowest / 2.0).maxCoeff();
  std::vector<Place> places;
  places.reserve(static_cast<std::size_t>(points.cols()));
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    Place place{Eigen::Vector3f::Zero(), static_cast<std::uint32_t>(i)};
    if (half > 0.0) place.at = ((points.col(i) / 2.0 - lowest / 2.0) / half).cast<float>();
    places.push_back(place);
  }
  return places;
}

Eigen::Index longest_side(PlaceIterator begin, PlaceIterator end) noexcept {
  Eigen::Vector3f low = begin->at;
  Eigen::Vector3f high = low;
  for (PlaceIterator place = begin; place != end; ++place) {
    low = low.cwiseMin(place->at);
    high = high.cwiseMax(place->at);
  }
  Eigen::Index longest = 0;
  (high - low).maxCoeff(&longest);
  return longest;
}

/// Half of the blocks, in whole groups of those that are evaluated together while there are
/// several.
std::size_t left_blocks(std::size_t blocks) noexcept {
  if (blocks < 2 * group_size) return blocks / 2;
  return (blocks / 2 + group_size / 2) / group_size * group_size;
}

void halve(PlaceIterator begin, PlaceIterator end) {
  const auto count = static_cast<std::size_t>(end - begin);
  if (count <= block_size) {
    std::sort(begin, end, [](const Place& a, const Place& b) { return a.index < b.index; });
    return;
  }
  const Eigen::Index axis = longest_side(begin, end);
  const std::size_t left = left_blocks(block_count_of(count)) * block_size;
  const PlaceIterator middle = begin + static_cast<std::ptrdiff_t>(left);
  // Equal coordinates by their indices: so the order is the same with every library.
  std::nth_element(begin, middle, end, [axis](const Place& a, const Place& b) {
    return std::tie(a.at[axis], a.index) < std::tie(b.at[axis], b.index);
  });
  halve(begin, middle);
  halve(middle, end);
}

/// Returns a permutation of the points in which each block_size points, from the first on, are a
/// leaf of a k-d tree (Bentley 1975, with leaves of one size). The tree halves points across the
/// longest side of their box until a leaf is left. In an octree's order, a block may span two cells
/// that are far apart; in this order, a support of a sixth of a scanned model meets a sixth to a
/// third fewer blocks. Points within a block are in the order of their indices, and points that are
/// not finite come last. Allocates.
std::vector<std::uint32_t> block_order(const Points& points) {
  std::vector<Place> places = places_of(points);
  const PlaceIterator finite =
      std::stable_partition(places.begin(), places.end(), [&points](const Place& place) {
        return points.col(place.index).allFinite();
      });
  halve(places.begin(), finite);
  std::vector<std::uint32_t> order;
  order.reserve(places.size());
  for (const Place& place : places)
    order.push_back(place.index);
  return order;
}

} // namespace

BlockShape::BlockShape(std::vector<VertexBlock> blocks)
    : blocks_(std::move(blocks)), stamps_(blocks_.size(), new_stamp()) {}

std::uint64_t BlockShape::new_stamp() noexcept {
  static std::atomic<std::uint64_t> last{0};
  static_assert(std::atomic<std::uint64_t>::is_always_lock_free);
  return last.fetch_add(1, std::memory_order_relaxed) + 1;
}

void BlockShape::follow(const BlockShape& other) {
  if (block_count() != other.block_count()) {
    *this = other;
    return;
  }
  for (std::size_t block = 0; block < block_count(); ++block)
    follow(other, block);
}

BlockLayout::BlockLayout(Points vertices)
    : original_(std::move(vertices)), diagonal_(diagonal_of(original_)),
      order_(block_order(original_)) {
  const auto [lowest, highest] = finite_box_of(original_);
  if (!(lowest[0] <= highest[0])) return;
  origin_ = lowest / 2.0 + highest / 2.0;
  const double half = (highest / 2.0 - lowest / 2.0).maxCoeff();
  // 2^-1000: where dividing by the unit would overflow.
  if (half > 0.0) unit_ = std::ldexp(1.0, std::clamp(std::ilogb(half) + 1, -1000, 1023));
}

/// A coordinate that is not finite stays in the middle, where it harms no bounds.
float BlockLayout::packed(double coordinate, Eigen::Index axis) const noexcept {
  return std::isfinite(coordinate) ? static_cast<float>((coordinate - origin_[axis]) / unit_)
                                   : 0.0F;
}

std::vector<std::uint32_t> BlockLayout::places() const {
  std::vector<std::uint32_t> places(vertex_count());
  for (std::size_t at = 0; at < places.size(); ++at)
    places[order_[at]] = static_cast<std::uint32_t>(at);
  return places;
}

BlockShape BlockLayout::pack(const Points& places) const {
  assert(places.cols() == original_.cols());
  std::vector<VertexBlock> blocks(block_count());
  for (std::size_t at = 0; at < blocks.size() * block_size; ++at) {
    const auto column = places.col(order_[std::min(at, order_.size() - 1)]);
    set_vertex(blocks[at / block_size], at % block_size,
               {packed(column[0], 0), packed(column[1], 1), packed(column[2], 2)});
  }
  return BlockShape(std::move(blocks));
}

void BlockLayout::unpack(const BlockShape& shape, Points& out) const {
  assert(shape.block_count() == block_count());
  if (out.cols() != original_.cols()) out.resize(3, original_.cols());
  for (std::size_t at = 0; at < order_.size(); ++at) {
    const auto vertex = static_cast<Eigen::Index>(order_[at]);
    const Eigen::Vector3f place = vertex_at(shape, at);
    for (Eigen::Index axis = 0; axis < 3; ++axis) {
      const double before = original_(axis, vertex);
      out(axis, vertex) = place[axis] == packed(before, axis)
                              ? before
                              : origin_[axis] + unit_ * static_cast<double>(place[axis]);
    }
  }
}

Eigen::Vector3d BlockLayout::rounded(const Eigen::Vector3d& place) const noexcept {
  Eigen::Vector3d result = place;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    const double coordinate = (place[axis] - origin_[axis]) / unit_;
    if (std::abs(coordinate) <= max_units)
      result[axis] = origin_[axis] + unit_ * static_cast<double>(static_cast<float>(coordinate));
  }
  return result;
}

double BlockLayout::rounded_radius(double radius) const noexcept {
  const double inverse = unit_ / radius;
  const bool fits = inverse <= max_units && inverse >= 1.0 / max_units; // false for NaN
  return fits ? unit_ / static_cast<double>(static_cast<float>(inverse)) : radius;
}

BlockShape shape_in_blocks(const Eigen::Matrix3Xf& shape, const BlockLayout& layout) {
  const std::vector<std::uint32_t>& order = layout.order();
  std::vector<VertexBlock> blocks(layout.block_count());
  for (std::size_t at = 0; at < blocks.size() * block_size; ++at) {
    const auto place = shape.col(static_cast<Eigen::Index>(order[std::min(at, order.size() - 1)]));
    set_vertex(blocks[at / block_size], at % block_size, place);
  }
  return BlockShape(std::move(blocks));
}

} // namespace nendo::deform
