#pragma once
// Indices and names of a hand's joint angles, for loops in limits, filters and reports.

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace nendo::hand {

/// The angles in JointAngles, in the same order: thumb, four fingers, palm, wrist.
enum class Angle : std::uint8_t {
  thumb_roll,
  thumb_abduction,
  thumb_mcp_flexion,
  thumb_ip_flexion,
  index_mcp_flexion,
  index_mcp_abduction,
  index_pip_flexion,
  index_dip_flexion,
  middle_mcp_flexion,
  middle_mcp_abduction,
  middle_pip_flexion,
  middle_dip_flexion,
  ring_mcp_flexion,
  ring_mcp_abduction,
  ring_pip_flexion,
  ring_dip_flexion,
  little_mcp_flexion,
  little_mcp_abduction,
  little_pip_flexion,
  little_dip_flexion,
  palm_arch,
  wrist_pitch,
  wrist_yaw,
};

inline constexpr std::size_t angle_count = 23;

inline constexpr std::array<std::string_view, angle_count> angle_names{
    "thumb_roll",         "thumb_abduction",      "thumb_mcp_flexion",  "thumb_ip_flexion",
    "index_mcp_flexion",  "index_mcp_abduction",  "index_pip_flexion",  "index_dip_flexion",
    "middle_mcp_flexion", "middle_mcp_abduction", "middle_pip_flexion", "middle_dip_flexion",
    "ring_mcp_flexion",   "ring_mcp_abduction",   "ring_pip_flexion",   "ring_dip_flexion",
    "little_mcp_flexion", "little_mcp_abduction", "little_pip_flexion", "little_dip_flexion",
    "palm_arch",          "wrist_pitch",          "wrist_yaw",
};

constexpr std::size_t index_of(Angle angle) noexcept {
  return static_cast<std::size_t>(angle);
}

constexpr std::string_view name_of(Angle angle) noexcept {
  return angle_names[index_of(angle)];
}

/// `index` must be below angle_count.
constexpr Angle angle_at(std::size_t index) noexcept {
  return static_cast<Angle>(index);
}

} // namespace nendo::hand
