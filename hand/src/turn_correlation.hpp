#pragma once
// Compares the turning velocities of one motion that two devices saw in different axes and with
// different delays.

#include <optional>
#include <vector>

#include <Eigen/Core>

namespace nendo::hand {

/// The turn of a forearm at one time, as one device sees it.
struct TimedTurn {
  double time_s = 0.0;
  Eigen::Matrix3d turn;
};

struct TurnMatch {
  double late_s = 0.0;           ///< how much later the times of the tracker are
  double late_deviation_s = 0.0; ///< standard deviation, without that of a hand that is not flat
  double correlation = 0.0;      ///< correlation of the velocities, in the same axes
  double heading_rad = 0.0;      ///< about the vertical, from the stage's axes to the hand's
};

inline constexpr double max_late_s = 0.4;

/// `by_tracker` are turns from the forearm (or anything that is fixed to it) to the stage, and
/// `by_wrist` from the forearm to the hand, which lies flat, within a few degrees, and still. Times
/// rise. nullopt if the two overlap too shortly. If one of them does not move, the correlation is
/// 0.
std::optional<TurnMatch> match_turns(const std::vector<TimedTurn>& by_tracker,
                                     const std::vector<TimedTurn>& by_wrist);

} // namespace nendo::hand
