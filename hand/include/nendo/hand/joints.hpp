#pragma once
// The joints of a hand: names and order of OpenXR's XR_EXT_hand_tracking, and the node numbers that
// the paper (Sato, Savchenko, Ohbuchi 2004, section 2.2) gives its VR Hand.

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

/// Returns "thumb_metacarpal" and so on.
NENDO_API std::string_view name_of(Joint joint) noexcept;

/// Returns the joint that carries this one, or nullopt for the wrist, which is the root. The wrist
/// carries the palm.
NENDO_API std::optional<Joint> parent_of(Joint joint) noexcept;

enum class Finger : std::uint8_t { thumb, index, middle, ring, little };

inline constexpr std::size_t finger_count = 5;

/// Returns "thumb" to "little".
NENDO_API std::string_view name_of(Finger finger) noexcept;

inline constexpr std::array<Joint, finger_count> fingertips{
    Joint::thumb_tip, Joint::index_tip, Joint::middle_tip, Joint::ring_tip, Joint::little_tip};

/// A node of the paper's VR Hand: its Parent is the wrist, PalmJoints 0-4 are the metacarpals of
/// thumb to little finger, and Joints 0-18 the rest: thumb 0-2, index 3-6, middle 7-10, ring 11-14,
/// little 15-18, each ending in the tip. The thumb's PalmJoint and Joints 3, 7, 11 and 15 turn in
/// two degrees of freedom.
struct PaperNode {
  enum class Kind : std::uint8_t { parent, palm_joint, joint };
  Kind kind = Kind::parent;
  std::uint8_t id = 0; ///< 0 for the Parent
  friend constexpr bool operator==(PaperNode, PaperNode) = default;
};

inline constexpr std::size_t paper_node_count = 25;

/// Returns the node of the paper for this joint, or nullopt for the palm, which the paper does not
/// have.
NENDO_API std::optional<PaperNode> paper_node_of(Joint joint) noexcept;
/// Returns the joint for a node of the paper, or nullopt if the paper has no such node.
NENDO_API std::optional<Joint> joint_of(PaperNode node) noexcept;

} // namespace nendo::hand
