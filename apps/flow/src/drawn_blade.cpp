// The part of the loop that draws wires and knives through the model.

#include <nendo/flow/deform_loop.hpp>

namespace nendo::flow {

namespace {

using Eigen::Vector3d;

Vector3d place_of(const HandFrame& hand, hand::Joint joint) {
  return hand.pose[joint].translation();
}

/// From the tip on, by that length, m.
deform::WirePlace knife_of(const HandFrame& hand, double length_m) {
  const Vector3d tip = place_of(hand, hand::Joint::index_tip);
  const Vector3d way = tip - place_of(hand, hand::Joint::index_proximal);
  return {tip, tip + length_m * way.normalized()};
}

/// 1: its index finger is stretched.
double straightness_of(const HandFrame& hand) {
  using hand::Joint;
  double length = 0.0;
  for (const auto& [from, to] : {std::pair{Joint::index_proximal, Joint::index_intermediate},
                                 {Joint::index_intermediate, Joint::index_distal},
                                 {Joint::index_distal, Joint::index_tip}})
    length += (place_of(hand, to) - place_of(hand, from)).norm();
  return (place_of(hand, Joint::index_tip) - place_of(hand, Joint::index_proximal)).norm() / length;
}

} // namespace

/// Hands that draw hold nothing meanwhile.
void DeformLoop::draw_blade(const DrawWire& draw) noexcept {
  constexpr double step_m = 0.002;
  if (!draw.on) {
    const std::uint32_t before = wire_.completed();
    wire_.end();
    if (wire_.completed() != before) drawn_wire_ = wire_;
    if (std::exchange(holds_after_wire_, false)) shaping_.ask(Request::grab);
    return;
  }
  if (!wire_.is_drawn()) holds_after_wire_ = shaping_.is_held();
  wire_.begin(step_m * units_per_metre_);
  blade_ = draw.blade;
  shaping_.ask(Request::let_go);
}

/// A wire is between both index fingertips, or thumb and index finger of the one hand that there
/// is. A knife is held by the hand that points more when it is drawn first.
void DeformLoop::follow_blade(const Frame& frame) noexcept {
  if (!wire_.is_drawn()) return;
  const auto& [left, right] = frame.hands;
  const HandFrame& one = left.present ? left : right;
  const bool has_both = left.present && right.present;
  deform::WirePlace place{place_of(one, hand::Joint::thumb_tip),
                          place_of(one, hand::Joint::index_tip)};
  if (blade_ == Blade::knife) {
    if (wire_.places().empty())
      knife_in_right_ =
          !left.present || (has_both && straightness_of(right) >= straightness_of(left));
    const double length_m = shaping_.model().layout().diagonal() / units_per_metre_;
    place = knife_of(knife_in_right_ ? right : left, length_m);
  } else if (has_both) {
    place = {place_of(left, hand::Joint::index_tip), place_of(right, hand::Joint::index_tip)};
  }
  wire_.draw_to({units_per_metre_ * place.from, units_per_metre_ * place.to});
}

} // namespace nendo::flow
