#pragma once
// Whether triangles of a surface meet elsewhere than at the corners and edges that they share.
// Decided exactly.

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "cut/exact_predicates.hpp"

namespace nendo::deform {

using SpaceTriangle = std::array<std::uint32_t, 3>; ///< of points' numbers

/// Returns true if two triangles have a point in common that is none of a shared corner's or
/// edge's. Corners are shared if their numbers are the same. Neither may have a corner twice.
bool triangles_meet(std::span<const SpacePoint> points, const SpaceTriangle& one,
                    const SpaceTriangle& other) noexcept;

/// A tree of boxes about triangles, for the pairs that can meet.
class TriangleTree {
public:
  /// Both must outlive the tree. Allocates.
  TriangleTree(std::span<const SpacePoint> points, std::span<const SpaceTriangle> triangles);
  /// Calls visit(k) with each triangle k whose box meets that of `triangle`, until it returns true.
  /// Returns whether it did.
  template <class Visit>
  bool any(const SpaceTriangle& triangle, const Visit& visit) const {
    if (nodes_.empty()) return false;
    const Box3 box = box_of(triangle);
    std::array<std::uint32_t, 64> stack{};
    std::size_t depth = 1;
    while (depth > 0) {
      const Node& node = nodes_[stack[--depth]];
      if (!meet(node.box, box)) continue;
      if (node.count > 0) {
        for (std::uint32_t at = node.first; at < node.first + node.count; ++at)
          if (meet(boxes_[at], box) && visit(order_[at])) return true;
      } else {
        stack[depth++] = node.first;
        stack[depth++] = node.first + 1;
      }
    }
    return false;
  }

private:
  struct Box3 {
    SpacePoint low, high;
  };
  struct Node {
    Box3 box;
    std::uint32_t first; ///< of its triangles in `order_`, or of its two children
    std::uint32_t count; ///< of triangles; 0: it has children
  };
  static bool meet(const Box3& a, const Box3& b) noexcept {
    return a.low[0] <= b.high[0] && b.low[0] <= a.high[0] && a.low[1] <= b.high[1] &&
           b.low[1] <= a.high[1] && a.low[2] <= b.high[2] && b.low[2] <= a.high[2];
  }
  Box3 box_of(const SpaceTriangle& triangle) const noexcept;
  void divide(std::uint32_t node, std::uint32_t first, std::uint32_t count);

  std::span<const SpacePoint> points_;
  std::vector<std::uint32_t> order_;
  std::vector<Box3> boxes_; ///< in order
  std::vector<Node> nodes_;
};

} // namespace nendo::deform
