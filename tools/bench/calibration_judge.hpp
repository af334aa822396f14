#pragma once
// Judges calibrations by wearers of whom the truth is known from elsewhere: a file of wearers.

#include <array>
#include <cstdint>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

#include "bench/judged_wearer.hpp"
#include "bench/stranger_hand.hpp"

namespace nendo::bench {

enum class Judged : std::uint8_t {
  full,       ///< the guided takes and the free motion
  closed,     ///< full, with pinches closed (hand::close_pinches())
  two_pose,   ///< flat and fist
  lines,      ///< the best line of each sensor, by the true angles of the motion itself: a bound
  worn_again, ///< the full calibration, after the glove was put on again
  touched_up, ///< that, touched up
  floor,      ///< StrangerFloor on the captures of full, with the true hand
  no_hand,    ///< the same without the true hand
};
inline constexpr std::array<std::string_view, 8> judged_names{
    "full", "closed", "two_pose", "best lines", "worn again", "touched up", "floor", "no hand"};

/// The last two rows are the distances of pads that touch, in millimetres; the others are degrees.
/// The former are of the wearer's pads, the latter of those of the hand that the program draws.
inline constexpr std::array<std::string_view, 10> judged_groups{
    "finger MCP",      "finger PIP",    "finger DIP", "abduction", "thumb roll",
    "thumb abduction", "thumb flexion", "wrist",      "pinch, mm", "pinch drawn, mm"};

template <class Value>
using JudgedTable = std::array<std::array<Value, judged_groups.size()>, judged_names.size()>;

struct Verdict {
  JudgedTable<std::vector<float>> errors;
  /// By group: how many wearers' 95th percentile is greater than that of the two-pose fit, by more
  /// than 0.3 degrees.
  std::array<int, judged_groups.size()> worse{};
  std::array<int, judged_groups.size()> floor_worse{}; ///< the same of the floor
  int wearers = 0;
  std::vector<std::string> refused; ///< names, and why
  std::vector<double> fit_ms;
};

/// Adds a wearer's errors. The floors are judged, if the wearer is a stranger whose true hand
/// is given; this takes a second.
void judge(const JudgedWearer& wearer, Verdict& verdict, const StrangerHand* hand = nullptr);

} // namespace nendo::bench
