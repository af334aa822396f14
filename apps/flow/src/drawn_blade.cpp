#include "drawn_blade.hpp"

#include <utility>

namespace nendo::flow {

namespace {

using Eigen::Vector3d;

Vector3d place_of(const puppet::HandState& hand, hand::Joint joint) {
  return hand.pose[joint].translation();
}

/// From the tip on, by that length, m.
deform::WirePlace knife_of(const puppet::HandState& hand, double length_m) {
  const Vector3d tip = place_of(hand, hand::Joint::index_tip);
  const Vector3d way = tip - place_of(hand, hand::Joint::index_proximal);
  return {tip, tip + length_m * way.normalized()};
}

/// 1: the index finger is straight.
double straightness_of(const puppet::HandState& hand) {
  using hand::Joint;
  double length = 0.0;
  for (const auto& [from, to] : {std::pair{Joint::index_proximal, Joint::index_intermediate},
                                 {Joint::index_intermediate, Joint::index_distal},
                                 {Joint::index_distal, Joint::index_tip}})
    length += (place_of(hand, to) - place_of(hand, from)).norm();
  return (place_of(hand, Joint::index_tip) - place_of(hand, Joint::index_proximal)).norm() / length;
}

} // namespace

void DrawnBlade::begin(Blade blade) noexcept {
  constexpr double step_m = 0.002;
  path_.begin(step_m * units_per_metre_);
  blade_ = blade;
}

void DrawnBlade::end() noexcept {
  const std::uint32_t before = path_.completed();
  path_.end();
  if (path_.completed() != before) completed_ = path_;
}

void DrawnBlade::follow(const Hands& hands, double knife_m) noexcept {
  if (!path_.is_drawing()) return;
  const auto& [left, right] = hands;
  const puppet::HandState& one = left != nullptr ? *left : *right;
  const bool has_both = left != nullptr && right != nullptr;
  deform::WirePlace place{place_of(one, hand::Joint::thumb_tip),
                          place_of(one, hand::Joint::index_tip)};
  if (blade_ == Blade::knife) {
    if (path_.places().empty())
      knife_in_right_ =
          left == nullptr || (has_both && straightness_of(*right) >= straightness_of(*left));
    place = knife_of(knife_in_right_ ? *right : *left, knife_m);
  } else if (has_both) {
    place = {place_of(*left, hand::Joint::index_tip), place_of(*right, hand::Joint::index_tip)};
  }
  path_.draw_to({units_per_metre_ * place.from, units_per_metre_ * place.to});
}

} // namespace nendo::flow
