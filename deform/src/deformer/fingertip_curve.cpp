#include "deformer/fingertip_curve.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace nendo::deform {

namespace {

/// Of a piece: a sample that is nearer to the curve's end is waited with; of one that is not,
/// fingertips that are nearer than the second rest.
constexpr double min_displacement = 0.5;
constexpr double min_move = 0.25;
/// A tangent longer than this times its chord would lead a cubic beyond its ends (Fritsch and
/// Carlson 1980).
constexpr double max_slope = 3.0;
/// Of a piece; what rounding may leave of a way that was to be cut into whole pieces.
constexpr double rounding = 1e-9;

double farthest(const Points& from, const Points& to) noexcept {
  return from.cols() == 0 ? 0.0 : std::sqrt((to - from).colwise().squaredNorm().maxCoeff());
}

/// A tangent that leads on along its chord, and not beyond its end.
void limit(const Eigen::Vector3d& chord, Eigen::Ref<Eigen::Vector3d> tangent) noexcept {
  const double squared = chord.squaredNorm();
  if (!(squared > 0.0)) {
    tangent.setZero();
    return;
  }
  const double along = tangent.dot(chord);
  if (along < 0.0) tangent -= along / squared * chord;
  const double longest = max_slope * max_slope * squared;
  const double length = tangent.squaredNorm();
  if (length > longest) tangent *= std::sqrt(longest / length);
}

} // namespace

FingertipCurve::FingertipCurve(Eigen::Index points, double piece_length)
    : piece_length_(piece_length), chord_(Points::Zero(3, points)), scratch_(chord_), from_(chord_),
      to_(chord_), leaving_(from_), arriving_(from_), tangent_(from_), slope_(from_),
      last_slope_(from_) {
  assert(piece_length > 0.0);
}

void FingertipCurve::begin(const Points& tips) {
  from_ = tips;
  to_ = tips;
  last_length_ = 0.0;
  lengths_.fill(0.0);
  cut_length_ = piece_length_;
  position_ = 0.0;
  carried_ = 0.0;
  ends_ = false;
}

void FingertipCurve::extend(const Points& tips) {
  if (farthest(to_, tips) < min_displacement * piece_length_) return;
  for (Eigen::Index i = 0; i < tips.cols(); ++i) {
    const bool moves = (tips.col(i) - to_.col(i)).norm() >= min_move * piece_length_;
    scratch_.col(i) = (moves ? tips : to_).col(i);
  }
  lead_to(scratch_);
}

void FingertipCurve::end_at(const Points& tips) {
  if (tips != to_) lead_to(tips);
  ends_ = true;
}

void FingertipCurve::lead_to(const Points& tips) {
  const double length = farthest(to_, tips);
  if (!(length > 0.0)) return; // too near for their distance to be a number
  carried_ += lengths_.back() - position_;
  position_ = 0.0;
  from_ = to_;
  to_ = tips;
  set_tangents(length);
  measure();
  const double whole = carried_ + lengths_.back();
  cut_length_ = std::max(piece_length_, whole / max_pieces);
  ends_ = false;
}

/// Curves are parametrised by the length of their chords: samples may be unevenly spaced.
void FingertipCurve::set_tangents(double length) noexcept {
  chord_ = to_ - from_;
  slope_ = chord_ / length;
  const bool first = last_length_ == 0.0;
  leaving_ = first ? slope_ : tangent_;
  tangent_ = slope_;
  if (!first) tangent_ += (slope_ - last_slope_) * (length / (length + last_length_));
  for (Eigen::Index i = 0; i < to_.cols(); ++i) {
    limit(slope_.col(i), leaving_.col(i));
    limit(slope_.col(i), tangent_.col(i));
  }
  leaving_ *= length;
  arriving_ = length * tangent_;
  last_slope_ = slope_;
  last_length_ = length;
}

namespace {

/// Hermite's cubic from 0: what chord and tangents weigh at u.
struct Weights {
  double chord, leaving, arriving;
};
constexpr Weights weights_at(double u) noexcept {
  const double v = 1.0 - u;
  return {u * u * (3.0 - 2.0 * u), u * v * v, -u * u * v};
}

/// What the products of chord and tangents with each other weigh in the square of each step: a
/// matrix, column by column.
template <std::size_t steps>
constexpr std::array<double, 6 * steps> squared_step_weights() noexcept {
  std::array<double, 6 * steps> weights{};
  Weights before{};
  for (std::size_t step = 0; step < steps; ++step) {
    const Weights here = weights_at(static_cast<double>(step + 1) / steps);
    const double c = here.chord - before.chord;
    const double l = here.leaving - before.leaving;
    const double a = here.arriving - before.arriving;
    const double products[] = {c * c, l * l, a * a, 2.0 * c * l, 2.0 * c * a, 2.0 * l * a};
    for (std::size_t column = 0; column < 6; ++column)
      weights[column * steps + step] = products[column];
    before = here;
  }
  return weights;
}

} // namespace

void FingertipCurve::measure() noexcept {
  static constexpr auto weights = squared_step_weights<steps>();
  const Eigen::Map<const Eigen::Matrix<double, steps, 6>> weights_by_step(weights.data());
  Eigen::Matrix<double, steps, 1> squared_lengths = Eigen::Matrix<double, steps, 1>::Zero();
  for (Eigen::Index i = 0; i < chord_.cols(); ++i) {
    const Eigen::Vector3d c = chord_.col(i);
    const Eigen::Vector3d l = leaving_.col(i);
    const Eigen::Vector3d a = arriving_.col(i);
    const Eigen::Vector<double, 6> products{c.squaredNorm(), l.squaredNorm(), a.squaredNorm(),
                                            c.dot(l),        c.dot(a),        l.dot(a)};
    squared_lengths = squared_lengths.cwiseMax(weights_by_step * products);
  }
  for (std::size_t step = 0; step < steps; ++step)
    lengths_[step + 1] =
        lengths_[step] + std::sqrt(squared_lengths[static_cast<Eigen::Index>(step)]);
}

bool FingertipCurve::next_cut(Points& cut) noexcept {
  const double left = lengths_.back() - position_;
  const double wanted = std::max(cut_length_ - carried_, 0.0);
  if (wanted > left + rounding * cut_length_) {
    if (!ends_ || !(carried_ + left > 0.0)) return false;
    position_ = lengths_.back();
    carried_ = 0.0;
    cut = to_;
    return true;
  }
  position_ = std::min(position_ + wanted, lengths_.back());
  carried_ = 0.0;
  if (position_ >= lengths_.back() * (1.0 - rounding)) { // exactly at the given place
    position_ = lengths_.back();
    cut = to_;
    return true;
  }
  const auto step = static_cast<std::size_t>(
      std::upper_bound(lengths_.begin(), lengths_.end(), position_) - lengths_.begin());
  const double part = (position_ - lengths_[step - 1]) / (lengths_[step] - lengths_[step - 1]);
  const Weights here = weights_at((static_cast<double>(step - 1) + part) / steps);
  cut = from_ + here.chord * chord_ + here.leaving * leaving_ + here.arriving * arriving_;
  return true;
}

} // namespace nendo::deform
