#pragma once
// The fingers' flexion sensors, and how the joints of a finger bend together: what is estimated
// where a glove has no such sensor, or where it is left out.

#include <algorithm>
#include <array>

#include <nendo/driver/sample.hpp>

namespace nendo::hand {

/// MCP, PIP and DIP of index, middle, ring and little finger.
inline constexpr std::array<std::array<Sensor, 3>, 4> finger_sensors{{
    {Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip},
    {Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip},
    {Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip},
    {Sensor::little_mcp, Sensor::little_pip, Sensor::little_dip},
}};

inline constexpr double pip_of_mcp = 1.1;

constexpr double bent(double angle_rad) noexcept {
  return std::max(angle_rad, 0.0);
}

constexpr double estimated_dip(double pip_rad) noexcept {
  return 0.32 * bent(pip_rad) * bent(pip_rad) + 0.17 * bent(pip_rad);
}

} // namespace nendo::hand
