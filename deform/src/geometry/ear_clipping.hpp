#pragma once
// Cuts a polygon in space into triangles by clipping ears (G. H. Meisters, Polygons have ears,
// 1975), as it looks against a normal. All decisions are exact.
//
// A corner is an ear if it is convex and nothing of the polygon lies in its triangle or on the
// triangle's new edge. What has no area, as spikes and ways between parts that touch, gives
// triangles without area. A polygon that crosses itself gets some triangles nevertheless.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/index.hpp>

#include "geometry/exact_predicates.hpp"
#include "geometry/space.hpp"

namespace nendo::deform {

struct CornerBox {
  PlanePoint lowest, highest;
};

/// Corners of a polygon by their places in the plane: a tree halved along x and y in turn, from
/// which corners are taken away. The same places give the same order.
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
    return find(0, to_index(order_.size()), 0, box, is_wanted);
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
  std::vector<std::uint32_t> counts_;   ///< corners left in the part that is headed here
  std::vector<std::uint32_t> position_; ///< each corner's place in order_; no_index: it was removed
};

class EarClipper {
public:
  /// Appends as many triangles as there are corners, less two; there must be three at least. The
  /// normal is as for turn_about(). Time: about n log n for what people model. Allocates.
  void run(std::span<const SpacePoint> places, const SpacePoint& normal,
           std::vector<Corners>& triangles);

private:
  enum Bend : std::int8_t { reflex = -1, flat = 0, convex = 1, clipped = 2 };

  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const noexcept {
    return turn_about(places_[a], places_[b], places_[c], normal_);
  }
  /// The scalar product of the ways from one corner to two others, as it looks.
  double product(std::uint32_t from, std::uint32_t to, std::uint32_t other) const noexcept;
  bool are_one(std::uint32_t a, std::uint32_t b) const noexcept { return places_[a] == places_[b]; }
  void start();
  void plant_tree();
  void push(std::uint32_t corner);
  void try_ear(std::uint32_t corner);
  void clip(std::uint32_t corner);
  bool is_thin(std::uint32_t corner) const noexcept;
  bool is_outside(std::uint32_t tip) const noexcept;
  void look_again(std::uint32_t corner);
  std::uint32_t best_of_the_rest();
  bool blocks(std::uint32_t other, const Corners& ear);
  std::uint32_t find_blocker(const Corners& ear);
  void watch(std::uint32_t corner, std::uint32_t blocker);
  void stop_watching(std::uint32_t corner);
  void free_watchers(std::uint32_t blocker);

  std::span<const SpacePoint> places_;
  SpacePoint normal_{};
  std::vector<Corners>* triangles_ = nullptr;
  std::vector<std::uint32_t> next_, last_;
  std::vector<Bend> bend_;
  std::uint32_t at_ = 0;           ///< some corner that is left
  std::uint32_t left_ = 0;         ///< the number of those
  std::vector<std::uint32_t> due_; ///< a ring of corners to be tried
  std::size_t due_at_ = 0, due_count_ = 0;
  std::vector<char> is_due_;
  std::vector<std::uint32_t> flats_; ///< corners that were flat once
  std::vector<std::uint32_t> thin_;  ///< tips without area, which are clipped first
  // Corners that are no ears wait in the list of one that lies in their triangle.
  std::vector<std::uint32_t> watchers_, next_watcher_, last_watcher_, watched_;
  std::vector<char> touches_; ///< it blocks only by where its edges lead
  CornerTree tree_;
  double margin_ = 0.0; ///< more than the places in the tree are off
};

} // namespace nendo::deform
