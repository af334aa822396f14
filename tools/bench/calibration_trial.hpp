#pragma once
// Calibrates one synthetic wearer in several ways, and measures how far each leaves the joints'
// angles from the true ones.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::bench {

enum class Method : std::uint8_t {
  full,     ///< the guided takes
  two_pose, ///< flat and fist
  min_max,  ///< counts of a free motion, spread over each joint's range of motion
  adaptive, ///< what hand::RangeAdaptation makes of the same counts
  floor,    ///< the true lines and couplings: what noise, 8 bits and bent lines leave
  slipped,  ///< full, after the sensors have slipped slowly
  followed, ///< the same with hand::SlipAdaptation, which has followed
};
inline constexpr std::array<std::string_view, 7> method_names{
    "full", "two_pose", "min_max", "adaptive", "floor", "slipped", "followed"};
inline constexpr std::array<std::string_view, 9> group_names{
    "finger MCP",       "finger PIP", "finger DIP",
    "finger abduction", "thumb roll", "thumb abduction",
    "thumb flexion",    "palm arch",  "wrist"};

/// A name for several consecutive groups.
struct JointFamily {
  std::string_view name;
  std::size_t first_group, end_group;
};
inline constexpr std::array<JointFamily, 2> families{
    {{"finger flexion", 0, 3}, {"whole thumb", 4, 7}}};

/// Absolute errors in degrees, by method and group of joints.
struct TrialErrors {
  std::array<std::array<std::vector<float>, group_names.size()>, method_names.size()> deg;
  std::vector<double> fit_ms;      ///< what the full fit took
  std::vector<double> condition;   ///< condition numbers of the full fit
  std::vector<double> touch_gap_m; ///< true gaps of the performed touches
};

/// Adds the errors of the wearer with this seed over another minute of free motion. Fails if a
/// capture or a fit fails.
Result<void> try_wearer(std::uint64_t seed, TrialErrors& errors);

} // namespace nendo::bench
