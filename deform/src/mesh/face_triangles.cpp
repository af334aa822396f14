// The triangles of faces: fans, or ears that are clipped (G. H. Meisters, Polygons have ears,
// 1975), as the polygon looks against its normal. All decisions are exact.
//
// A corner is an ear if it is convex and nothing of the polygon lies in its triangle or on the
// triangle's new edge. Parts without area, as spikes and the two sides of a slit, give triangles
// without area. A polygon that crosses itself gets some triangles nevertheless.

#include <nendo/deform/triangles.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/space.hpp"
#include "mesh/columns.hpp"

namespace nendo::deform {
namespace {

/// Of fewer corners, all are looked at.
constexpr std::uint32_t min_for_tree = 48;
/// How many corners are looked at where a polygon crosses itself.
constexpr int max_looks = 64;
/// How far a spike is followed to where it begins.
constexpr int max_steps = 64;

/// Products of three coordinates must neither overflow nor lose digits (exact_predicates.hpp).
constexpr double max_extent = 1e60;
constexpr double min_extent = 1e-60;

/// Returns the direction of a vector, exactly: a power of two makes its largest coordinate 0.5 to
/// 1. Nothing but zero if it has no direction.
SpacePoint as_direction(const SpacePoint& vector) noexcept {
  const double largest = std::max({std::abs(vector[0]), std::abs(vector[1]), std::abs(vector[2])});
  if (!(largest > 0.0) || !std::isfinite(vector[0] + vector[1] + vector[2])) return {};
  int exponent = 0;
  std::frexp(largest, &exponent);
  return {std::ldexp(vector[0], -exponent), std::ldexp(vector[1], -exponent),
          std::ldexp(vector[2], -exponent)};
}

/// Returns the direction of the polygon's area vector, or zero.
SpacePoint face_normal(const std::vector<SpacePoint>& places) noexcept {
  SpacePoint area{};
  SpacePoint before = places[1] - places[0];
  double extent = std::max({std::abs(before[0]), std::abs(before[1]), std::abs(before[2])});
  for (std::size_t at = 2; at < places.size(); ++at) {
    const SpacePoint here = places[at] - places[0];
    area = area + cross(before, here);
    extent = std::max({extent, std::abs(here[0]), std::abs(here[1]), std::abs(here[2])});
    before = here;
  }
  if (!(extent <= max_extent) || !(extent >= min_extent)) return {};
  return as_direction(area);
}

bool is_none(const SpacePoint& vector) noexcept {
  return vector[0] == 0.0 && vector[1] == 0.0 && vector[2] == 0.0;
}

/// Returns whether all triangles of the fan about the first corner face the way of the polygon.
bool is_fan(const std::vector<SpacePoint>& places, const SpacePoint& normal) noexcept {
  for (std::size_t at = 2; at < places.size(); ++at)
    if (turn_about(places[0], places[at - 1], places[at], normal) <= 0) return false;
  return true;
}

struct CornerBox {
  PlanePoint lowest, highest;
};

/// Corners of a polygon by their places in the plane: a tree halved along x and y in turn, from
/// which corners are taken away. The same places give the same order.
class CornerTree {
public:
  /// Holds these corners, whose places are in `places`. Allocates.
  void plant(std::vector<PlanePoint> places, std::vector<std::uint32_t> corners) {
    places_ = std::move(places);
    order_ = std::move(corners);
    counts_.assign(order_.size(), 0);
    position_.assign(places_.size(), no_index);
    halve(0, to_index(order_.size()), 0);
    for (std::uint32_t at = 0; at < order_.size(); ++at)
      position_[order_[at]] = at;
  }
  void clear() noexcept { order_.clear(); }
  bool empty() const noexcept { return order_.empty(); }
  const PlanePoint& place(std::uint32_t corner) const noexcept { return places_[corner]; }
  /// Takes a corner away; nothing happens if it is not there.
  void remove(std::uint32_t corner) noexcept {
    const std::uint32_t position = position_[corner];
    if (position == no_index) return;
    position_[corner] = no_index;
    std::uint32_t begin = 0;
    auto end = to_index(order_.size());
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
  /// Calls is_wanted(corner) for those in the box until it returns true. Returns that corner, or
  /// no_index.
  template <class IsWanted>
  std::uint32_t find(const CornerBox& box, const IsWanted& is_wanted) const {
    return find(0, to_index(order_.size()), 0, box, is_wanted);
  }

private:
  /// No two corners are equal in this order, so each middle is the same wherever this runs.
  void halve(std::uint32_t begin, std::uint32_t end, std::size_t axis) {
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
           std::vector<Corners>& triangles) {
    places_ = places;
    normal_ = normal;
    triangles_ = &triangles;
    start();
    while (left_ > 3) {
      if (!thin_.empty()) {
        const std::uint32_t corner = thin_.back();
        thin_.pop_back();
        if (is_thin(corner)) clip(corner);
        continue;
      }
      if (due_count_ == 0) {
        clip(best_of_the_rest());
        continue;
      }
      const std::uint32_t corner = due_[due_at_];
      due_at_ = (due_at_ + 1) % due_.size();
      --due_count_;
      is_due_[corner] = 0;
      try_ear(corner);
    }
    triangles.push_back({last_[at_], at_, next_[at_]});
  }

private:
  enum Bend : std::int8_t { reflex = -1, flat = 0, convex = 1, clipped = 2 };

  int turn(std::uint32_t a, std::uint32_t b, std::uint32_t c) const noexcept {
    return turn_about(places_[a], places_[b], places_[c], normal_);
  }
  /// The scalar product of the vectors from one corner to two others, projected along the normal.
  double product(std::uint32_t from, std::uint32_t to, std::uint32_t other) const noexcept {
    const SpacePoint a = places_[to] - places_[from], b = places_[other] - places_[from];
    return dot(a, b) - dot(a, normal_) * dot(b, normal_) / dot(normal_, normal_);
  }
  bool are_one(std::uint32_t a, std::uint32_t b) const noexcept { return places_[a] == places_[b]; }
  void start() {
    const auto count = to_index(places_.size());
    next_.resize(count);
    last_.resize(count);
    for (std::uint32_t corner = 0; corner < count; ++corner) {
      next_[corner] = corner + 1 < count ? corner + 1 : 0;
      last_[corner] = corner > 0 ? corner - 1 : count - 1;
    }
    at_ = 0;
    left_ = count;
    bend_.resize(count);
    flats_.clear();
    for (std::uint32_t corner = 0; corner < count; ++corner) {
      bend_[corner] = static_cast<Bend>(turn(last_[corner], corner, next_[corner]));
      if (bend_[corner] == flat) flats_.push_back(corner);
    }
    thin_.clear();
    for (const std::uint32_t corner : flats_)
      if (is_thin(corner) && is_outside(corner)) thin_.push_back(corner);
    for (auto* links : {&watchers_, &next_watcher_, &last_watcher_, &watched_})
      links->assign(count, no_index);
    touches_.assign(count, 0);
    tree_.clear();
    if (count >= min_for_tree) plant_tree();
    due_.resize(count);
    is_due_.assign(count, 0);
    due_at_ = due_count_ = 0;
    // Every second corner first: neighbours make one long fan.
    for (std::uint32_t first = 0; first < 2; ++first)
      for (std::uint32_t corner = first; corner < count; corner += 2)
        push(corner);
  }
  /// In the coordinate plane that the polygon is the most parallel to, along the normal. Only
  /// corners that are not convex can lie in ears, and convex ones stay convex.
  void plant_tree() {
    std::size_t axis = 0;
    for (std::size_t k = 1; k < 3; ++k)
      if (std::abs(normal_[k]) > std::abs(normal_[axis])) axis = k;
    const std::size_t x = (axis + 1) % 3, y = (axis + 2) % 3;
    std::vector<PlanePoint> places;
    std::vector<std::uint32_t> corners;
    places.reserve(places_.size());
    double extent = 0.0;
    for (std::uint32_t corner = 0; corner < places_.size(); ++corner) {
      const SpacePoint from = places_[corner] - places_[0];
      const double up = from[axis] / normal_[axis];
      places.push_back({from[x] - up * normal_[x], from[y] - up * normal_[y]});
      extent = std::max({extent, std::abs(from[x]), std::abs(from[y]), std::abs(up)});
      if (bend_[corner] != convex) corners.push_back(corner);
    }
    margin_ = 1e-14 * extent;
    if (!corners.empty()) tree_.plant(std::move(places), std::move(corners));
  }
  void push(std::uint32_t corner) {
    if (is_due_[corner] != 0 || bend_[corner] != convex) return;
    is_due_[corner] = 1;
    due_[(due_at_ + due_count_++) % due_.size()] = corner;
  }
  void try_ear(std::uint32_t corner) {
    if (bend_[corner] != convex) return;
    const std::uint32_t blocker = find_blocker({last_[corner], corner, next_[corner]});
    if (blocker == no_index)
      clip(corner);
    else
      watch(corner, blocker);
  }
  void clip(std::uint32_t corner) {
    const std::uint32_t before = last_[corner], after = next_[corner];
    triangles_->push_back({before, corner, after});
    next_[before] = after;
    last_[after] = before;
    bend_[corner] = clipped;
    at_ = before;
    --left_;
    if (!tree_.empty()) tree_.remove(corner);
    stop_watching(corner);
    free_watchers(corner);
    look_again(before);
    look_again(after);
  }
  /// The way to the corner and the way on are one, or one of them has no length. Angles become
  /// smaller by clipping, so where that comes about there is nothing between the two ways.
  bool is_thin(std::uint32_t corner) const noexcept {
    if (bend_[corner] != flat) return false;
    const std::uint32_t before = last_[corner], after = next_[corner];
    return are_one(corner, before) || are_one(corner, after) ||
           product(corner, before, after) > 0.0;
  }
  /// Of a tip that was there from the beginning: a spike leads outwards, a slit inwards. The
  /// polygon's other edges decide where it begins.
  bool is_outside(std::uint32_t tip) const noexcept {
    std::uint32_t one = last_[tip], other = next_[tip];
    if (are_one(tip, one) || are_one(tip, other)) return true;
    for (int step = 0; step < max_steps; ++step) {
      const bool ends_at_one = are_one(one, other);
      const bool other_is_nearer =
          !ends_at_one && product(tip, other, other) < product(tip, one, one);
      const std::uint32_t root = other_is_nearer ? other : one;
      const std::uint32_t before = other_is_nearer ? one : last_[one];
      const std::uint32_t after = ends_at_one || other_is_nearer ? next_[other] : other;
      const int bend = turn(before, root, after);
      const bool left = turn(root, after, tip) > 0, right = turn(root, before, tip) < 0;
      if (bend > 0) return !(left && right);
      if (bend < 0) return !(left || right);
      if (product(root, before, after) < 0.0) return !left;
      one = before;
      other = after;
    }
    return true;
  }
  /// After one of its neighbours has become another.
  void look_again(std::uint32_t corner) {
    const Bend was = bend_[corner];
    bend_[corner] = static_cast<Bend>(turn(last_[corner], corner, next_[corner]));
    if (bend_[corner] == flat) {
      flats_.push_back(corner);
      if (is_thin(corner)) thin_.push_back(corner);
    }
    if (touches_[corner] != 0 || (was != convex && bend_[corner] == convex)) free_watchers(corner);
    if (bend_[corner] == convex && !tree_.empty()) tree_.remove(corner);
    push(corner);
  }
  /// No corner is an ear. Those that are flat take no area away; otherwise the polygon crosses
  /// itself.
  std::uint32_t best_of_the_rest() {
    while (!flats_.empty()) {
      const std::uint32_t corner = flats_.back();
      flats_.pop_back();
      if (bend_[corner] == flat) return corner;
    }
    std::uint32_t corner = at_;
    for (int look = 0; look < max_looks && bend_[corner] != convex; ++look)
      corner = next_[corner];
    return corner;
  }
  /// A corner in the place of one of the ear's, or on an edge that the ear has already, blocks if
  /// one of its edges leads into the ear.
  bool blocks(std::uint32_t other, const Corners& ear) {
    const std::uint32_t u = ear[0], v = ear[1], w = ear[2];
    const int uv = turn(u, v, other);
    if (uv < 0) return false;
    const int vw = turn(v, w, other);
    if (vw < 0) return false;
    const int wu = turn(w, u, other);
    if (wu < 0) return false;
    if (uv > 0 && vw > 0) return true;
    const auto leads_in = [&](std::uint32_t to) {
      const auto between = [&](std::uint32_t from, std::uint32_t right, std::uint32_t left) {
        return turn(from, right, to) > 0 && turn(from, left, to) < 0;
      };
      if (uv == 0 && wu == 0) return between(u, v, w);
      if (uv == 0 && vw == 0) return between(v, w, u);
      if (vw == 0 && wu == 0) return between(w, u, v);
      return uv == 0 ? turn(u, v, to) > 0 : turn(v, w, to) > 0;
    };
    if (!leads_in(next_[other]) && !leads_in(last_[other])) return false;
    touches_[other] = 1;
    return true;
  }
  std::uint32_t find_blocker(const Corners& ear) {
    if (places_.size() < min_for_tree) {
      for (std::uint32_t other = next_[ear[2]]; other != ear[0]; other = next_[other])
        if (bend_[other] != convex && blocks(other, ear)) return other;
      return no_index;
    }
    if (tree_.empty()) return no_index;
    CornerBox box{};
    for (std::size_t axis = 0; axis < 2; ++axis) {
      const auto [low, high] = std::minmax(
          {tree_.place(ear[0])[axis], tree_.place(ear[1])[axis], tree_.place(ear[2])[axis]});
      box.lowest[axis] = low - margin_;
      box.highest[axis] = high + margin_;
    }
    return tree_.find(box, [&](std::uint32_t other) {
      return other != ear[0] && other != ear[1] && other != ear[2] && blocks(other, ear);
    });
  }
  void watch(std::uint32_t corner, std::uint32_t blocker) {
    stop_watching(corner);
    watched_[corner] = blocker;
    last_watcher_[corner] = no_index;
    next_watcher_[corner] = watchers_[blocker];
    if (watchers_[blocker] != no_index) last_watcher_[watchers_[blocker]] = corner;
    watchers_[blocker] = corner;
  }
  void stop_watching(std::uint32_t corner) {
    const std::uint32_t blocker = watched_[corner];
    if (blocker == no_index) return;
    const std::uint32_t before = last_watcher_[corner], after = next_watcher_[corner];
    (before == no_index ? watchers_[blocker] : next_watcher_[before]) = after;
    if (after != no_index) last_watcher_[after] = before;
    watched_[corner] = no_index;
  }
  void free_watchers(std::uint32_t blocker) {
    touches_[blocker] = 0;
    while (watchers_[blocker] != no_index) {
      const std::uint32_t corner = watchers_[blocker];
      stop_watching(corner);
      push(corner);
    }
  }

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

} // namespace

struct FaceTriangles::Parts {
  std::vector<SpacePoint> places; ///< a face's corners
  SpacePoint normal{};            ///< the face's; zero if it has none
  EarClipper clipper;
};

FaceTriangles::FaceTriangles(const Mesh& mesh, const Points& places)
    : mesh_(mesh), places_(places) {}

FaceTriangles::~FaceTriangles() = default;

/// Notes the places of the corners. Returns whether the face has a normal.
bool FaceTriangles::take(std::uint32_t begin, std::uint32_t count) {
  if (!parts_) parts_ = std::make_unique<Parts>();
  parts_->places.resize(count);
  for (std::uint32_t at = 0; at < count; ++at)
    parts_->places[at] = space_point(places_, mesh_.face_corners[begin + at]);
  parts_->normal = face_normal(parts_->places);
  return !is_none(parts_->normal);
}

std::span<const Triangle> FaceTriangles::of_polygon(std::uint32_t begin, std::uint32_t count) {
  some_.clear();
  if (count < 3) return some_;
  const bool has_normal = take(begin, count);
  const bool fan = !has_normal || is_fan(parts_->places, parts_->normal);
  if (fan)
    for (std::uint32_t at = 2; at < count; ++at)
      some_.push_back({0, at - 1, at});
  else
    parts_->clipper.run(parts_->places, parts_->normal, some_);
  for (Triangle& triangle : some_)
    for (std::uint32_t& corner : triangle)
      corner += begin;
  if (!fan || !has_normal)
    std::erase_if(some_, [&](const Triangle& triangle) {
      const std::uint32_t a = mesh_.face_corners[triangle[0]];
      const std::uint32_t b = mesh_.face_corners[triangle[1]];
      const std::uint32_t c = mesh_.face_corners[triangle[2]];
      return a == b || b == c || c == a;
    });
  return some_;
}

bool FaceTriangles::is_convex(std::size_t face) {
  const std::uint32_t begin = mesh_.face_starts[face];
  const std::uint32_t count = mesh_.face_starts[face + 1] - begin;
  if (count < 4 || !take(begin, count)) return true;
  const std::vector<SpacePoint>& places = parts_->places;
  for (std::size_t at = 0; at < count; ++at)
    if (turn_about(places[at], places[(at + 1) % count], places[(at + 2) % count], parts_->normal) <
        0)
      return false;
  return true;
}

} // namespace nendo::deform
