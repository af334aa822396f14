#pragma once
// Finds the vertices near a body. The cost is what is near: a block is looked at if its bounds meet
// the body's box, and then only against the parts whose boxes it meets.

#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include <nendo/deform/contact_part.hpp>

#include "block_evaluator.hpp"
#include "simd/contact_kernels.hpp"

namespace nendo::deform {

/// Lets a block's bounds through that meet a box.
struct BoxGate {
  BlockBounds limits{}; ///< highest x, y, z, infinity; negated lowest x, y, z, infinity

  /// Returns the gate of no box at all.
  static BoxGate shut() noexcept;
  static BoxGate of(const ContactPart& part) noexcept;
  void extend(const BoxGate& other) noexcept;
  bool meets(const BlockBounds& bounds, float margin) const noexcept {
    bool all = true;
    for (std::size_t side = 0; side < 8; ++side)
      all = all & (bounds.sides[side] <= limits.sides[side] + margin);
    return all;
  }
};

class ContactSearch {
public:
  /// Allocates.
  ContactSearch(std::size_t bodies, std::size_t parts_a_body);

  /// Sets the parts of all bodies, in a layout's coordinates. Does not allocate.
  void set_parts(std::span<const ContactPart> parts) noexcept;
  std::size_t bodies() const noexcept { return bodies_; }
  /// Tells whether a block is within `margin` of a box of one of the bodies.
  bool is_any_near(const BoundedShape& shape, std::span<const BoxGate> boxes,
                   double margin) const noexcept;
  const BoxGate& box_of(std::size_t body) const noexcept { return body_boxes_[body]; }

  /// Calls visit(block, nearest) for the blocks within `margin` of the body's parts, in order.
  /// Distances are right if they are at most `margin`, and otherwise more than it.
  template <class Visit>
  void each_near(const BoundedShape& shape, std::size_t body, double margin, const Visit& visit);
  /// Returns how many distances were computed since it was last set to 0.
  std::size_t& distances() noexcept { return distances_; }

private:
  void add_cone(const ContactPart& part, std::size_t first, std::size_t second) noexcept;
  void add_plane(const ContactPart& part, PartEntry& entry) noexcept;
  std::size_t list_parts(const BlockBounds& bounds, std::size_t body, float margin) noexcept;

  std::size_t bodies_;
  std::size_t parts_a_body_;
  std::vector<ConeEntry> cones_;
  std::vector<PlaneEntry> planes_;
  std::vector<PartEntry> parts_;
  std::vector<BoxGate> part_boxes_, body_boxes_;
  std::vector<std::uint32_t> list_;
  std::size_t distances_ = 0;
  NearestLanes nearest_{};
};

template <class Visit>
void ContactSearch::each_near(const BoundedShape& shape, std::size_t body, double margin,
                              const Visit& visit) {
  const auto wide = static_cast<float>(margin);
  const PartArrays arrays{cones_.data(), planes_.data(), parts_.data()};
  for (std::size_t block = 0; block < shape.bounds.size(); ++block) {
    if (!body_boxes_[body].meets(shape.bounds[block], wide)) continue;
    const std::size_t count = list_parts(shape.bounds[block], body, wide);
    if (count == 0) continue;
    nearest_in_block(shape.shape[block], arrays, list_.data(), count, nearest_);
    distances_ += count * block_size;
    visit(block, nearest_);
  }
}

} // namespace nendo::deform
