#pragma once
// Finds the vertices near a body. The cost is what is near: a block is looked at if its bounds meet
// the body's box, and then only against the parts that may be the nearest to one of its vertices.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/contact_part.hpp>

#include "field/block_evaluator.hpp"
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
  ContactSearch(std::size_t bodies, std::size_t parts_per_body);

  /// Sets the parts of all bodies, in a layout's coordinates. Does not allocate.
  void set_parts(std::span<const ContactPart> parts) noexcept;
  std::size_t bodies() const noexcept { return bodies_; }
  /// Leaves a part out of each_near(), or no longer.
  void leave_out(std::size_t part, bool is_out) noexcept { is_out_[part] = is_out ? 1 : 0; }
  /// Returns whether a block is within `margin` of a box of one of the bodies.
  bool is_any_near(const BoundedShape& shape, std::span<const BoxGate> boxes,
                   double margin) const noexcept;

  /// Calls visit(block, nearest) for the blocks within `margin` of the body's parts, in order.
  /// Distances are right if they are at most `margin`, and otherwise more than it.
  template <class Visit>
  void each_near(const BoundedShape& shape, std::size_t body, double margin, const Visit& visit);
  /// Does the same for these blocks only.
  template <class Visit>
  void each_of(const BoundedShape& shape, std::size_t body, std::span<const std::uint32_t> blocks,
               double margin, const Visit& visit);
  /// Returns how many distances were computed since it was last set to 0.
  std::size_t& distances() noexcept { return distances_; }

private:
  /// The boxes of up to 64 blocks.
  struct Boxes {
    std::size_t count = 0;
    std::array<std::uint32_t, block_size> blocks{};
    BoxLanes lanes;
    NearestFromBoxes nearest;
    std::array<std::uint32_t, block_size> list_sizes{};
  };

  void add_cone(const ContactPart& part, std::size_t first, std::size_t second) noexcept;
  void add_plane(const ContactPart& part, PartEntry& entry) noexcept;
  PartArrays arrays() const noexcept { return {cones_.data(), planes_.data(), parts_.data()}; }
  void add_box(const BlockBounds& bounds, std::uint32_t block) noexcept;
  void measure_boxes(std::size_t body, float margin) noexcept;
  void list_part(std::uint32_t part, std::uint64_t near) noexcept;
  template <class Each, class Visit>
  void visit_each(const BoundedShape& shape, std::size_t body, float margin, const Each& each,
                  const Visit& visit);
  template <class Visit>
  void visit_boxes(const BoundedShape& shape, std::size_t body, float margin, const Visit& visit);

  std::size_t bodies_;
  std::size_t parts_per_body_;
  std::vector<ConeEntry> cones_;
  std::vector<PlaneEntry> planes_;
  std::vector<PartEntry> parts_;
  std::vector<std::uint8_t> is_out_; ///< a part
  std::vector<BoxGate> body_boxes_;
  std::size_t distances_ = 0;
  NearestLanes nearest_{};
  Boxes boxes_;
  std::vector<PartFromBoxes> seen_;  ///< each part of a body, from 64 boxes
  std::vector<std::uint32_t> lists_; ///< the parts that may be the nearest to each of 64 boxes
};

template <class Visit>
void ContactSearch::each_near(const BoundedShape& shape, std::size_t body, double margin,
                              const Visit& visit) {
  const auto wide = static_cast<float>(margin);
  const auto blocks = static_cast<std::uint32_t>(shape.bounds.size());
  const auto each = [&](const auto& take) {
    for (std::uint32_t block = 0; block < blocks; ++block)
      if (body_boxes_[body].meets(shape.bounds[block], wide)) take(block);
  };
  visit_each(shape, body, wide, each, visit);
}

template <class Visit>
void ContactSearch::each_of(const BoundedShape& shape, std::size_t body,
                            std::span<const std::uint32_t> blocks, double margin,
                            const Visit& visit) {
  const auto each = [&](const auto& take) { std::for_each(blocks.begin(), blocks.end(), take); };
  visit_each(shape, body, static_cast<float>(margin), each, visit);
}

/// `each(take)` calls take(block) for each block.
template <class Each, class Visit>
void ContactSearch::visit_each(const BoundedShape& shape, std::size_t body, float margin,
                               const Each& each, const Visit& visit) {
  boxes_.count = 0;
  each([&](std::uint32_t block) {
    add_box(shape.bounds[block], block);
    if (boxes_.count == block_size) visit_boxes(shape, body, margin, visit);
  });
  if (boxes_.count > 0) visit_boxes(shape, body, margin, visit);
}

template <class Visit>
void ContactSearch::visit_boxes(const BoundedShape& shape, std::size_t body, float margin,
                                const Visit& visit) {
  measure_boxes(body, margin);
  for (std::size_t box = 0; box < boxes_.count; ++box) {
    const std::size_t count = boxes_.list_sizes[box];
    if (count == 0) continue;
    const std::size_t block = boxes_.blocks[box];
    nearest_in_block(shape.shape[block], arrays(), lists_.data() + box * parts_per_body_, count,
                     nearest_);
    distances_ += count * block_size;
    visit(block, nearest_);
  }
  boxes_.count = 0;
}

} // namespace nendo::deform
