#include "geometry/corner_tree.hpp"

#include <algorithm>
#include <utility>

namespace nendo::deform {

void CornerTree::plant(std::vector<PlanePoint> places, std::vector<std::uint32_t> corners) {
  places_ = std::move(places);
  order_ = std::move(corners);
  counts_.assign(order_.size(), 0);
  position_.assign(places_.size(), no_index);
  halve(0, static_cast<std::uint32_t>(order_.size()), 0);
  for (std::uint32_t at = 0; at < order_.size(); ++at)
    position_[order_[at]] = at;
}

/// No two corners are equal in this order, so each middle is the same wherever this runs.
void CornerTree::halve(std::uint32_t begin, std::uint32_t end, std::size_t axis) {
  if (begin == end) return;
  const std::uint32_t middle = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + middle, order_.begin() + end,
                   [&](std::uint32_t one, std::uint32_t other) {
                     return std::pair(places_[one][axis], one) <
                            std::pair(places_[other][axis], other);
                   });
  counts_[middle] = end - begin;
  halve(begin, middle, 1 - axis);
  halve(middle + 1, end, 1 - axis);
}

void CornerTree::remove(std::uint32_t corner) noexcept {
  const std::uint32_t position = position_[corner];
  if (position == no_index) return;
  position_[corner] = no_index;
  std::uint32_t begin = 0;
  auto end = static_cast<std::uint32_t>(order_.size());
  for (;;) {
    const std::uint32_t middle = begin + (end - begin) / 2;
    --counts_[middle];
    if (middle == position) return;
    if (position < middle)
      end = middle;
    else
      begin = middle + 1;
  }
}

} // namespace nendo::deform
