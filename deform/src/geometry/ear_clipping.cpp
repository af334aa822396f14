#include "geometry/ear_clipping.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <nendo/deform/index.hpp>

namespace nendo::deform {
namespace {

/// Of fewer corners, all are looked at.
constexpr std::uint32_t min_for_tree = 48;
/// How many corners are looked at where a polygon crosses itself.
constexpr int max_looks = 64;
/// How far a spike is followed to where it begins.
constexpr int max_steps = 64;

} // namespace

void EarClipper::run(std::span<const SpacePoint> places, const SpacePoint& normal,
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

void EarClipper::start() {
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

/// In the coordinate plane that the polygon is the most parallel to, along the normal. Only corners
/// that are not convex can lie in ears, and convex ones stay convex.
void EarClipper::plant_tree() {
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

double EarClipper::product(std::uint32_t from, std::uint32_t to,
                           std::uint32_t other) const noexcept {
  const SpacePoint a = places_[to] - places_[from], b = places_[other] - places_[from];
  return dot(a, b) - dot(a, normal_) * dot(b, normal_) / dot(normal_, normal_);
}

/// The way to the corner and the way on are one, or one of them has no length. Angles become
/// smaller by clipping, so where that comes about there is nothing between the two ways.
bool EarClipper::is_thin(std::uint32_t corner) const noexcept {
  if (bend_[corner] != flat) return false;
  const std::uint32_t before = last_[corner], behind = next_[corner];
  return are_one(corner, before) || are_one(corner, behind) ||
         product(corner, before, behind) > 0.0;
}

/// Of a tip that was there from the beginning: a spike leads outwards, a slit inwards. Where it
/// begins, the polygon's other edges tell.
bool EarClipper::is_outside(std::uint32_t tip) const noexcept {
  std::uint32_t one = last_[tip], other = next_[tip];
  if (are_one(tip, one) || are_one(tip, other)) return true;
  for (int step = 0; step < max_steps; ++step) {
    const bool ends_at_one = are_one(one, other);
    const bool other_is_nearer =
        !ends_at_one && product(tip, other, other) < product(tip, one, one);
    const std::uint32_t root = other_is_nearer ? other : one;
    const std::uint32_t before = other_is_nearer ? one : last_[one];
    const std::uint32_t behind = ends_at_one || other_is_nearer ? next_[other] : other;
    const int bend = turn(before, root, behind);
    const bool left = turn(root, behind, tip) > 0, right = turn(root, before, tip) < 0;
    if (bend > 0) return !(left && right);
    if (bend < 0) return !(left || right);
    if (product(root, before, behind) < 0.0) return !left;
    one = before;
    other = behind;
  }
  return true;
}

void EarClipper::push(std::uint32_t corner) {
  if (is_due_[corner] != 0 || bend_[corner] != convex) return;
  is_due_[corner] = 1;
  due_[(due_at_ + due_count_++) % due_.size()] = corner;
}

void EarClipper::try_ear(std::uint32_t corner) {
  if (bend_[corner] != convex) return;
  const std::uint32_t blocker = find_blocker({last_[corner], corner, next_[corner]});
  if (blocker == no_index)
    clip(corner);
  else
    watch(corner, blocker);
}

void EarClipper::clip(std::uint32_t corner) {
  const std::uint32_t before = last_[corner], behind = next_[corner];
  triangles_->push_back({before, corner, behind});
  next_[before] = behind;
  last_[behind] = before;
  bend_[corner] = clipped;
  at_ = before;
  --left_;
  if (!tree_.empty()) tree_.remove(corner);
  stop_watching(corner);
  free_watchers(corner);
  look_again(before);
  look_again(behind);
}

/// After one of its neighbours has become another.
void EarClipper::look_again(std::uint32_t corner) {
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
std::uint32_t EarClipper::best_of_the_rest() {
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

/// A corner in the place of one of the ear's, or on an edge that the ear has already, blocks if one
/// of its edges leads into the ear.
bool EarClipper::blocks(std::uint32_t other, const Corners& ear) {
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

std::uint32_t EarClipper::find_blocker(const Corners& ear) {
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

void EarClipper::watch(std::uint32_t corner, std::uint32_t blocker) {
  stop_watching(corner);
  watched_[corner] = blocker;
  last_watcher_[corner] = no_index;
  next_watcher_[corner] = watchers_[blocker];
  if (watchers_[blocker] != no_index) last_watcher_[watchers_[blocker]] = corner;
  watchers_[blocker] = corner;
}

void EarClipper::stop_watching(std::uint32_t corner) {
  const std::uint32_t blocker = watched_[corner];
  if (blocker == no_index) return;
  const std::uint32_t before = last_watcher_[corner], behind = next_watcher_[corner];
  (before == no_index ? watchers_[blocker] : next_watcher_[before]) = behind;
  if (behind != no_index) last_watcher_[behind] = before;
  watched_[corner] = no_index;
}

void EarClipper::free_watchers(std::uint32_t blocker) {
  touches_[blocker] = 0;
  while (watchers_[blocker] != no_index) {
    const std::uint32_t corner = watchers_[blocker];
    stop_watching(corner);
    push(corner);
  }
}

void CornerTree::plant(std::vector<PlanePoint> places, std::vector<std::uint32_t> corners) {
  places_ = std::move(places);
  order_ = std::move(corners);
  counts_.assign(order_.size(), 0);
  position_.assign(places_.size(), no_index);
  halve(0, to_index(order_.size()), 0);
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

} // namespace nendo::deform
