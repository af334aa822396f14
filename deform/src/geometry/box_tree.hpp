#pragma once
// A tree of boxes around triangles: which of them may meet.

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include "geometry/space.hpp"

namespace nendo::deform {

struct SpaceBox {
  SpacePoint low, high;
};

inline bool meet(const SpaceBox& a, const SpaceBox& b) noexcept {
  return a.low[0] <= b.high[0] && b.low[0] <= a.high[0] && a.low[1] <= b.high[1] &&
         b.low[1] <= a.high[1] && a.low[2] <= b.high[2] && b.low[2] <= a.high[2];
}

inline void widen(SpaceBox& box, const SpaceBox& by) noexcept {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    box.low[axis] = std::min(box.low[axis], by.low[axis]);
    box.high[axis] = std::max(box.high[axis], by.high[axis]);
  }
}
SpaceBox box_around(std::span<const SpacePoint> places, const Corners& triangle) noexcept;

/// The tree keeps no reference to what it was built of.
class BoxTree {
public:
  /// Of the triangles whose numbers are in `chosen`; of all triangles without it. Allocates.
  BoxTree(std::span<const SpacePoint> places, std::span<const Corners> triangles);
  BoxTree(std::span<const SpacePoint> places, std::span<const Corners> triangles,
          std::vector<std::uint32_t> chosen);

  bool empty() const noexcept { return order_.empty(); }
  /// The box around all triangles. The tree must not be empty.
  const SpaceBox& box() const noexcept { return nodes_.front().box; }

  /// Calls visit(triangle) for each triangle of which enters(box) is true, for its box and for
  /// those around it, until visit returns true. Returns whether it did.
  template <class Enters, class Visit>
  bool any(const Enters& enters, const Visit& visit) const {
    return any_leaf(enters, [&](const Node& leaf) {
      for (std::uint32_t at = leaf.first; at < leaf.first + leaf.count; ++at)
        if (enters(boxes_[at]) && visit(order_[at])) return true;
      return false;
    });
  }

  /// Calls visit(triangle) for all of them.
  template <class Enters, class Visit>
  void visit(const Enters& enters, const Visit& visit) const {
    any(enters, [&](std::uint32_t triangle) {
      visit(triangle);
      return false;
    });
  }

  /// Calls visit(own triangle, other's triangle) for each two whose boxes meet.
  template <class Visit>
  void visit_pairs(const BoxTree& other, const Visit& visit) const {
    for (const Node& own : nodes_) {
      if (own.count == 0) continue;
      other.any_leaf([&](const SpaceBox& box) { return meet(box, own.box); },
                     [&](const Node& leaf) {
                       for (std::uint32_t at = own.first; at < own.first + own.count; ++at)
                         other.visit_met(leaf, boxes_[at],
                                         [&](std::uint32_t theirs) { visit(order_[at], theirs); });
                       return false;
                     });
    }
  }

private:
  struct Node {
    SpaceBox box;
    std::uint32_t first; ///< a leaf's first triangle in order_, or the first of two children
    std::uint32_t count; ///< 0: no leaf
  };
  /// Calls visit(leaf) for each leaf of which enters(box) is true, for its box and for those around
  /// it, until visit returns true. Returns whether it did.
  template <class Enters, class Visit>
  bool any_leaf(const Enters& enters, const Visit& visit) const {
    if (empty()) return false;
    std::uint32_t stack[64];
    std::size_t depth = 0;
    stack[depth++] = 0;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      if (!enters(node.box)) continue;
      if (node.count == 0) {
        stack[depth++] = node.first;
        stack[depth++] = node.first + 1;
      } else if (visit(node)) {
        return true;
      }
    }
    return false;
  }
  /// Calls visit(triangle) for each triangle of the leaf whose box meets that one.
  template <class Visit>
  void visit_met(const Node& leaf, const SpaceBox& box, const Visit& visit) const {
    for (std::uint32_t at = leaf.first; at < leaf.first + leaf.count; ++at)
      if (meet(boxes_[at], box)) visit(order_[at]);
  }
  void build(std::span<const SpacePoint> places, std::span<const Corners> triangles);
  void split(std::uint32_t node, std::uint32_t begin, std::uint32_t count);
  SpaceBox box_of(const Node& node) const noexcept;

  std::vector<Node> nodes_;
  std::vector<std::uint32_t> order_; ///< triangles, leaf by leaf
  std::vector<SpaceBox> boxes_;      ///< in this order
};

} // namespace nendo::deform
