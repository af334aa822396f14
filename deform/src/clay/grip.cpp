#include "clay/grip.hpp"

#include <algorithm>
#include <cmath>

#include <nendo/deform/wendland.hpp>

#include "clay/press_problem.hpp"
#include "clay/rigid_fit.hpp"

namespace nendo::deform {

using Eigen::Index;
using Eigen::Vector3d;

namespace {

constexpr double min_load_mm = 0.1;
constexpr double max_width_mm = 80.0;
constexpr double facing = 0.5; // a cosine
constexpr double beside_mm = 4.0;
constexpr double opened = 1.15;
constexpr double opened_mm = 6.0;
constexpr int calls_to_change = 6; // so that tremor does not flicker

} // namespace

Grip::Grip(std::size_t first_part, std::size_t parts, double mm)
    : first_part_(first_part), mm_(mm), sides_(parts) {
  loaded_.reserve(4 * max_held);
  held_.reserve(max_held);
}

void Grip::begin_look() noexcept {
  loaded_.clear();
  for (Side& side : sides_) {
    side.load = side.closes = 0.0;
    side.place = side.across = Vector3d::Zero();
  }
}

void Grip::look(const ContactPoint& point, double load) noexcept {
  if (holds() || load < min_load_mm * mm_ || loaded_.size() == loaded_.capacity()) return;
  loaded_.push_back({point, load});
  Side& side = sides_[point.part - first_part_];
  side.load += load;
  side.place += load * point.at;
}

/// The mean normal of the places that a part pushes along `way`, or zero.
Vector3d Grip::normal_along(std::size_t part, const Vector3d& way) const noexcept {
  Vector3d sum = Vector3d::Zero();
  for (const Loaded& loaded : loaded_)
    if (loaded.point.part == first_part_ + part && loaded.point.normal.dot(way) > facing)
      sum += loaded.load * loaded.point.normal;
  return sum.normalized();
}

/// How far a part has gone along `way` in this call, at what it presses.
double Grip::gone(std::span<const ContactPart> parts, std::size_t side,
                  const Vector3d& way) const noexcept {
  const Vector3d place = sides_[side].place / sides_[side].load;
  const Eigen::Isometry3d& frame = parts[first_part_ + side].frame;
  return (place - sides_[side].frame * before_motion(frame, place)).dot(way);
}

/// Two parts face each other if each pushes something towards the other.
bool Grip::find_facing(std::span<const ContactPart> parts) noexcept {
  bool is_any = false;
  for (std::size_t i = 0; i < sides_.size(); ++i)
    for (std::size_t j = i + 1; j < sides_.size(); ++j) {
      Side& one = sides_[i];
      Side& other = sides_[j];
      if (!(one.load > 0.0 && other.load > 0.0)) continue;
      const Vector3d across = other.place / other.load - one.place / one.load;
      const double width = across.norm();
      if (!(width > 0.0 && width < max_width_mm * mm_)) continue;
      const Vector3d way = across / width;
      if (normal_along(i, way).dot(normal_along(j, -way)) > -facing) continue;
      one.across += way;
      other.across -= way;
      const double closes = gone(parts, i, way) - gone(parts, j, way);
      one.closes = std::max(one.closes, closes);
      other.closes = std::max(other.closes, closes);
    }
  for (Side& side : sides_) {
    side.closed = side.across.isZero(0.0) ? 0.0 : side.closed + side.closes;
    is_any = is_any || side.has_closed(mm_);
  }
  return is_any;
}

/// The way from the middle of the places that the second side holds to that of the first.
Vector3d Grip::across(std::span<const ContactPart> parts) const noexcept {
  Vector3d first = Vector3d::Zero();
  Vector3d second = Vector3d::Zero();
  for (std::size_t at = 0; at < held_.size(); ++at) {
    const Vector3d place = parts[held_[at].part].frame * held_[at].local;
    (at < held_side_ ? first : second) += place;
  }
  const auto firsts = static_cast<double>(held_side_);
  const auto seconds = static_cast<double>(held_.size() - held_side_);
  return first / firsts - second / seconds;
}

void Grip::follow(std::span<const ContactPart> parts) noexcept {
  if (!holds()) return;
  const Vector3d way = across(parts);
  const double width = way.norm();
  narrowest_ = std::min(narrowest_, width);
  const Vector3d opening =
      width > narrowest_ ? Vector3d(0.5 * (width - narrowest_) / width * way) : Vector3d::Zero();
  for (std::size_t at = 0; at < held_.size(); ++at) {
    const Vector3d place = parts[held_[at].part].frame * held_[at].local;
    held_[at].goal = at < held_side_ ? Vector3d(place - opening) : Vector3d(place + opening);
  }
}

/// Places beside the vertex are held, so that a part also turns what it holds.
void Grip::hold(const ContactPart& part, const ContactPoint& point, const Vector3d& by) noexcept {
  const Vector3d place = point.at + by;
  held_.push_back({point.part, before_motion(part.frame, place), place, place});
}

/// The first side is that of the first part and of those that push alike.
void Grip::take(std::span<const ContactPart> parts) noexcept {
  Vector3d first_way = Vector3d::Zero();
  for (const Side& side : sides_)
    if (first_way.isZero(0.0) && side.has_closed(mm_)) first_way = side.across;
  for (const bool is_first : {true, false}) {
    std::size_t left = is_first ? max_held / 2 : max_held - held_.size();
    for (const Loaded& loaded : loaded_) {
      const Side& side = sides_[loaded.point.part - first_part_];
      if (left < 3 || !side.has_closed(mm_)) continue;
      if ((side.across.dot(first_way) > 0.0) != is_first) continue;
      if (loaded.point.normal.dot(side.across.normalized()) < facing) continue;
      const Vector3d beside = beside_mm * mm_ * loaded.point.normal.unitOrthogonal();
      for (const Vector3d& by :
           {Vector3d(Vector3d::Zero()), beside, Vector3d(loaded.point.normal.cross(beside))})
        hold(parts[loaded.point.part], loaded.point, by);
      left -= 3;
    }
    if (is_first) held_side_ = held_.size();
  }
  if (held_side_ == 0 || held_side_ == held_.size()) return release();
  for (const HeldPoint& point : held_)
    sides_[point.part - first_part_].is_held = true;
  narrowest_ = across(parts).norm();
}

bool Grip::end_look(std::span<const ContactPart> parts) noexcept {
  const bool held = holds();
  const bool is_changing =
      held ? across(parts).norm() > std::min(opened * narrowest_, narrowest_ + opened_mm * mm_)
           : find_facing(parts);
  for (std::size_t side = 0; side < sides_.size(); ++side)
    sides_[side].frame = parts[first_part_ + side].frame;
  calls_ = is_changing ? calls_ + 1 : 0;
  if (calls_ < calls_to_change) return false;
  held ? release() : take(parts);
  calls_ = 0;
  return held != holds();
}

void Grip::take_over(const Grip& other, double scale, const Vector3d& origin) noexcept {
  held_.assign(other.held_.begin(), other.held_.end());
  for (HeldPoint& point : held_) {
    point.local *= scale;
    point.at = scale * point.at + origin;
    point.goal = scale * point.goal + origin;
  }
  held_side_ = other.held_side_;
  narrowest_ = scale * other.narrowest_;
  calls_ = other.calls_;
  for (std::size_t side = 0; side < sides_.size(); ++side) {
    const Side& from = other.sides_[side];
    sides_[side].frame = from.frame;
    sides_[side].frame.translation() = scale * from.frame.translation() + origin;
    sides_[side].closed = scale * from.closed;
    sides_[side].is_held = from.is_held;
  }
}

void Grip::release() noexcept {
  held_.clear();
  held_side_ = 0;
  calls_ = 0;
  for (Side& side : sides_) {
    side.is_held = false;
    side.closed = 0.0;
  }
}

namespace {

// Places of one part move together and need no exact fit.
constexpr double held_ridge = 1e-3;

} // namespace

HeldField::HeldField(std::size_t most)
    : places_(3, static_cast<Index>(most)), ways_(places_), coefficients_(places_),
      psi_(static_cast<Index>(most), static_cast<Index>(most)), factor_(psi_) {}

void HeldField::add(std::size_t at, const Vector3d& place, const Vector3d& way) noexcept {
  places_.col(static_cast<Index>(at)) = place;
  ways_.col(static_cast<Index>(at)) = way;
}

/// Cholesky's factorisation by columns, in place: for some dozens of places, and without
/// allocating.
double HeldField::solve(std::size_t count, double radius) noexcept {
  count_ = static_cast<Index>(count);
  radius_ = radius;
  for (Index i = 0; i < count_; ++i)
    for (Index j = 0; j <= i; ++j)
      psi_(i, j) = psi_(j, i) =
          wendland(Wendland::c2, (places_.col(i) - places_.col(j)).norm() / radius);
  for (Index j = 0; j < count_; ++j) {
    auto column = factor_.col(j).segment(j, count_ - j);
    column = psi_.col(j).segment(j, count_ - j);
    column[0] += held_ridge;
    for (Index k = 0; k < j; ++k)
      column -= factor_(j, k) * factor_.col(k).segment(j, count_ - j);
    column /= std::sqrt(column[0]);
  }
  for (Index i = 0; i < count_; ++i) {
    Vector3d sum = ways_.col(i);
    for (Index k = 0; k < i; ++k)
      sum -= factor_(i, k) * coefficients_.col(k);
    coefficients_.col(i) = sum / factor_(i, i);
  }
  for (Index i = count_; i-- > 0;) {
    Vector3d sum = coefficients_.col(i);
    for (Index k = i + 1; k < count_; ++k)
      sum -= factor_(k, i) * coefficients_.col(k);
    coefficients_.col(i) = sum / factor_(i, i);
  }
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (Index i = 0; i < count_; ++i) {
    Vector3d sum = Vector3d::Zero();
    for (Index j = 0; j < count_; ++j)
      sum += psi_(i, j) * coefficients_.col(j);
    gram += coefficients_.col(i) * sum.transpose();
  }
  return bound_of_gram(gram, radius);
}

Vector3d HeldField::field_at(const Vector3d& place) const noexcept {
  Vector3d sum = Vector3d::Zero();
  for (Index i = 0; i < count_; ++i)
    sum += wendland(Wendland::c2, (place - places_.col(i)).norm() / radius_) * coefficients_.col(i);
  return sum;
}

} // namespace nendo::deform
