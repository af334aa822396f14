#pragma once
// The joints of a hand: names and order of OpenXR's XR_EXT_hand_tracking.

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include <nendo/base/api.hpp>

namespace nendo::hand {

enum class Joint : std::uint8_t {
  palm,
  wrist,
  thumb_metacarpal,
  thumb_proximal,
  thumb_distal,
  thumb_tip,
  index_metacarpal,
  index_proximal,
  index_intermediate,
  index_distal,
  index_tip,
  middle_metacarpal,
  middle_proximal,
  middle_intermediate,
  middle_distal,
  middle_tip,
  ring_metacarpal,
  ring_proximal,
  ring_intermediate,
  ring_distal,
  ring_tip,
  little_metacarpal,
  little_proximal,
  little_intermediate,
  little_distal,
  little_tip,
};

inline constexpr std::size_t joint_count = 26;

constexpr std::size_t index_of(Joint joint) noexcept {
  return static_cast<std::size_t>(joint);
}

/// Returns the joint that is `steps` places later in the order; along a finger, nearer to its tip.
constexpr Joint joint_after(Joint joint, std::size_t steps) noexcept {
  return static_cast<Joint>(index_of(joint) + steps);
}
NENDO_API std::string_view name_of(Joint joint) noexcept;

enum class Finger : std::uint8_t { thumb, index, middle, ring, little };

inline constexpr std::size_t finger_count = 5;

NENDO_API std::string_view name_of(Finger finger) noexcept;

inline constexpr std::array<Joint, finger_count> metacarpals{
    Joint::thumb_metacarpal, Joint::index_metacarpal, Joint::middle_metacarpal,
    Joint::ring_metacarpal, Joint::little_metacarpal};
inline constexpr std::array<Joint, finger_count> fingertips{
    Joint::thumb_tip, Joint::index_tip, Joint::middle_tip, Joint::ring_tip, Joint::little_tip};

/// Returns the parent joint, or nullopt for the wrist, which is the root and the palm's parent.
constexpr std::optional<Joint> parent_of(Joint joint) noexcept {
  if (joint == Joint::wrist) return std::nullopt;
  if (joint == Joint::palm ||
      std::find(metacarpals.begin(), metacarpals.end(), joint) != metacarpals.end())
    return Joint::wrist;
  return static_cast<Joint>(index_of(joint) - 1); // a finger's joints are in order
}

} // namespace nendo::hand
