#include "lucidgloves/lucidgloves_slots.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

namespace nendo::driver::lucidgloves {
namespace {

constexpr Sensor none = Sensor::unused;

/// By finger and joint, from the metacarpal out.
constexpr std::array<std::array<Sensor, joints>, fingers> joint_slots{
    {{none, Sensor::thumb_mcp, Sensor::thumb_ip, none},
     {none, Sensor::index_mcp, Sensor::index_pip, Sensor::index_dip},
     {none, Sensor::middle_mcp, Sensor::middle_pip, Sensor::middle_dip},
     {none, Sensor::ring_mcp, Sensor::ring_pip, Sensor::ring_dip},
     {none, Sensor::pinky_mcp, Sensor::pinky_pip, Sensor::pinky_dip}}};
constexpr std::size_t mcp = 1;

/// Between finger k and the next, from the index finger on.
constexpr std::size_t index = 1;
constexpr std::array<Sensor, fingers - 2> pair_slots{
    Sensor::index_middle_abduction, Sensor::middle_ring_abduction, Sensor::ring_pinky_abduction};

std::uint16_t apart(std::uint16_t one, std::uint16_t other, std::uint16_t range) noexcept {
  const int difference = one > other ? one - other : other - one;
  return static_cast<std::uint16_t>(std::min(2 * difference, int{range}));
}

} // namespace

void fill_slots(const Line& line, std::uint16_t range, GloveSample& sample) noexcept {
  for (std::size_t finger = 0; finger < fingers; ++finger) {
    if (line.curl[finger]) sample.set(joint_slots[finger][mcp], RawCount{*line.curl[finger]});
    for (std::size_t joint = 0; joint < joints; ++joint) {
      const Sensor sensor = joint_slots[finger][joint];
      if (line.joint[finger][joint] && sensor != none)
        sample.set(sensor, RawCount{*line.joint[finger][joint]});
    }
  }
  if (line.splay[0]) sample.set(Sensor::thumb_abduction, RawCount{*line.splay[0]});
  for (std::size_t pair = 0; pair < pair_slots.size(); ++pair) {
    const auto& one = line.splay[index + pair];
    const auto& other = line.splay[index + pair + 1];
    if (one && other) sample.set(pair_slots[pair], RawCount{apart(*one, *other, range)});
  }
}

} // namespace nendo::driver::lucidgloves
