#pragma once
// The gloves and trackers of a loop that a server shares.

#include <cstdint>
#include <vector>

#include <nendo/base/side.hpp>
#include <nendo/driver/glove.hpp>
#include <nendo/driver/tracker.hpp>

namespace nendo::serve {

struct ServedGlove {
  std::uint8_t input = 0;  ///< the index of the loop's input (flow::TakenSample::hand)
  Side side = Side::right; ///< the hand that it moves (flow::HandInput::side)
  driver::GloveInfo info;
};

/// The station that moves the wrist of a hand.
struct ServedTracker {
  Side side = Side::right; ///< the hand (flow::TakenPose::side); each has one at most
  std::uint16_t station = 0;
  driver::TrackerInfo info;
};

struct Devices {
  std::vector<ServedGlove> gloves;
  std::vector<ServedTracker> trackers;
};

} // namespace nendo::serve
