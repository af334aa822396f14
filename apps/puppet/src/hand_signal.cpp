#include <nendo/puppet/hand_signal.hpp>

#include <algorithm>
#include <utility>

#include <nendo/hand/angle.hpp>

namespace nendo::puppet {
namespace {

constexpr std::size_t first_tip = hand::finger_count + hand::angle_count;
constexpr std::size_t count = first_tip + 3 * hand::finger_count;

std::string finger_name(std::size_t finger) {
  return std::string(hand::name_of(static_cast<hand::Finger>(finger)));
}

double flexion(const hand::JointAngles& angles, std::size_t finger) noexcept {
  if (finger == 0) return angles.thumb_mcp_flexion_rad + angles.thumb_ip_flexion_rad;
  const hand::FingerAngles& bent = angles.fingers[finger - 1];
  return bent.mcp_flexion_rad + bent.pip_flexion_rad + bent.dip_flexion_rad;
}

std::string name_of(std::size_t number) {
  if (number < hand::finger_count) return finger_name(number) + "_flexion";
  if (number < first_tip) return std::string(hand::angle_names[number - hand::finger_count]);
  const std::size_t tip = number - first_tip;
  return finger_name(tip / 3) + "_tip_" + "xyz"[tip % 3];
}

} // namespace

std::optional<HandSignal> HandSignal::named(std::string_view name) noexcept {
  const auto point = name.find('.');
  const std::string_view side = name.substr(0, point);
  if (point == std::string_view::npos || (side != "left" && side != "right")) return std::nullopt;
  for (std::size_t number = 0; number < count; ++number)
    if (name.substr(point + 1) == name_of(number))
      return HandSignal(side == "left" ? Side::left : Side::right,
                        static_cast<std::uint8_t>(number));
  return std::nullopt;
}

std::optional<HandSignal> HandSignal::numbered(Side side, std::uint8_t number) noexcept {
  if (number >= count) return std::nullopt;
  return HandSignal(side, number);
}

HandSignal HandSignal::mirrored() const noexcept {
  return {side_ == Side::left ? Side::right : Side::left, number_};
}

std::string HandSignal::name() const {
  return (side_ == Side::left ? "left." : "right.") + name_of(number_);
}

bool HandSignal::is_angle() const noexcept {
  return number_ < first_tip;
}

std::uint8_t HandSignal::finger() const noexcept {
  if (number_ < hand::finger_count) return number_;
  if (number_ >= first_tip) return static_cast<std::uint8_t>((number_ - first_tip) / 3);
  // Four angles of the thumb, four of each finger, then palm and wrist.
  return std::min(static_cast<std::uint8_t>((number_ - hand::finger_count) / 4), no_finger);
}

Eigen::Vector3d HandSignal::direction() const noexcept {
  const auto axis = static_cast<Eigen::Index>((number_ - first_tip) % 3);
  Eigen::Vector3d direction = Eigen::Vector3d::Unit(axis);
  if (side_ == Side::left && axis == 0) direction = -direction; // x points to a left hand's thumb
  return direction;
}

double HandSignal::of(const HandState& hand) const noexcept {
  if (number_ < hand::finger_count) return flexion(hand.angles, number_);
  if (number_ < first_tip) return hand.angles[hand::angle_at(number_ - hand::finger_count)];
  const std::size_t tip = number_ - first_tip;
  const Eigen::Vector3d world =
      hand.pose.fingertip_positions().col(static_cast<Eigen::Index>(tip / 3));
  const Eigen::Vector3d place =
      hand.T_world_wrist.linear().transpose() * (world - hand.T_world_wrist.translation());
  return direction().dot(place);
}

} // namespace nendo::puppet
