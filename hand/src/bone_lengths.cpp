#include <nendo/hand/bone_lengths.hpp>

#include <cstdio>
#include <string>
#include <string_view>

#include <nendo/hand/joints.hpp>

namespace nendo::hand {
namespace {

Result<void> check_bone(std::string_view finger, std::string_view bone, double length_m) {
  // Written so that a NaN is refused.
  if (length_m >= BoneLengths::min_m && length_m <= BoneLengths::max_m) return {};
  char length[32];
  std::snprintf(length, sizeof length, "%g", length_m);
  return Error{Errc::bad_input, std::string(finger) + " " + std::string(bone) + " bone: " + length +
                                    " m is not the length of a bone: give metres, 0.001 to 0.2"};
}

} // namespace

Result<void> BoneLengths::check() const {
  static constexpr std::array<std::string_view, 4> bone_names{"metacarpal", "proximal",
                                                              "intermediate", "distal"};
  static constexpr std::array<std::string_view, 3> thumb_names{"metacarpal", "proximal", "distal"};
  for (std::size_t bone = 0; bone < thumb_m.size(); ++bone) {
    if (auto checked = check_bone("thumb", thumb_names[bone], thumb_m[bone]); !checked)
      return checked;
  }
  for (std::size_t finger = 0; finger < fingers_m.size(); ++finger) {
    for (std::size_t bone = 0; bone < bone_names.size(); ++bone) {
      const auto name = name_of(static_cast<Finger>(finger + 1)); // the thumb has its own
      auto checked = check_bone(name, bone_names[bone], fingers_m[finger][bone]);
      if (!checked) return checked;
    }
  }
  return {};
}

} // namespace nendo::hand
