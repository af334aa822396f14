#pragma once
// Corners of a polygon by their places in the plane: which lie in a box? A tree halved along x and
// y in turn, from which corners are taken away. The same places give the same order.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/index.hpp>

#include "geometry/exact_predicates.hpp"

namespace nendo::deform {

struct CornerBox {
  PlanePoint lowest, highest;
};

class CornerTree {
public:
  /// Holds these corners, whose places are in `places`. Allocates.
  void plant(std::vector<PlanePoint> places, std::vector<std::uint32_t> corners);
  void clear() noexcept { order_.clear(); }
  bool empty() const noexcept { return order_.empty(); }
  const PlanePoint& place(std::uint32_t corner) const noexcept { return places_[corner]; }
  /// Takes a corner away; nothing happens if it is not there.
  void remove(std::uint32_t corner) noexcept;
  /// Calls is_wanted(corner) for those in the box until it returns true. Returns that corner, or
  /// no_index.
  template <class IsWanted>
  std::uint32_t find(const CornerBox& box, const IsWanted& is_wanted) const {
    return find(0, static_cast<std::uint32_t>(order_.size()), 0, box, is_wanted);
  }

private:
  void halve(std::uint32_t begin, std::uint32_t end, std::size_t axis);
  template <class IsWanted>
  std::uint32_t find(std::uint32_t begin, std::uint32_t end, std::size_t axis, const CornerBox& box,
                     const IsWanted& is_wanted) const {
    const std::uint32_t middle = begin + (end - begin) / 2;
    if (begin == end || counts_[middle] == 0) return no_index;
    const std::uint32_t corner = order_[middle];
    const PlanePoint& place = places_[corner];
    if (box.lowest[axis] <= place[axis])
      if (const auto found = find(begin, middle, 1 - axis, box, is_wanted); found != no_index)
        return found;
    const bool is_in = box.lowest[0] <= place[0] && place[0] <= box.highest[0] &&
                       box.lowest[1] <= place[1] && place[1] <= box.highest[1];
    if (is_in && position_[corner] != no_index && is_wanted(corner)) return corner;
    return place[axis] <= box.highest[axis] ? find(middle + 1, end, 1 - axis, box, is_wanted)
                                            : no_index;
  }

  std::vector<PlanePoint> places_;
  std::vector<std::uint32_t> order_;    ///< a part of it is headed by its middle
  std::vector<std::uint32_t> counts_;   ///< of what is left of the part that is headed here
  std::vector<std::uint32_t> position_; ///< of each corner in the order; no_index: it is not there
};

} // namespace nendo::deform
