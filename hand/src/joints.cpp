#include <nendo/hand/joints.hpp>

namespace nendo::hand {
namespace {

constexpr std::array<std::string_view, joint_count> names{
    "palm",
    "wrist",
    "thumb_metacarpal",
    "thumb_proximal",
    "thumb_distal",
    "thumb_tip",
    "index_metacarpal",
    "index_proximal",
    "index_intermediate",
    "index_distal",
    "index_tip",
    "middle_metacarpal",
    "middle_proximal",
    "middle_intermediate",
    "middle_distal",
    "middle_tip",
    "ring_metacarpal",
    "ring_proximal",
    "ring_intermediate",
    "ring_distal",
    "ring_tip",
    "little_metacarpal",
    "little_proximal",
    "little_intermediate",
    "little_distal",
    "little_tip",
};

constexpr std::array<std::string_view, finger_count> finger_names{"thumb", "index", "middle",
                                                                  "ring", "little"};

} // namespace

std::string_view name_of(Joint joint) noexcept {
  return names[index_of(joint)];
}

std::string_view name_of(Finger finger) noexcept {
  return finger_names[static_cast<std::size_t>(finger)];
}

} // namespace nendo::hand
