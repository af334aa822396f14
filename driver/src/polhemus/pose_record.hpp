#pragma once
// What a record of a Polhemus tracker without a clock contains.

#include <array>
#include <cstdint>

namespace nendo::driver::polhemus {

inline constexpr std::uint16_t max_station = 12; ///< the highest number in such records
inline constexpr double max_norm_error = 0.002;  ///< how far a quaternion may be off. Chosen.

struct PoseRecord {
  std::uint16_t station = 0;
  char error = ' '; ///< a letter, or a blank for none
  std::array<double, 3> position_m{};
  std::array<double, 4> turn_xyzw{};
};

constexpr bool is_error(char letter) noexcept {
  return letter == ' ' || (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z');
}

} // namespace nendo::driver::polhemus
