#pragma once
// What is known of the person who wears a glove: for each of the two hands its calibration and its
// size, and whether the calibration is to be learned while the glove is used. One glove box may see
// both hands, since a glove of the other side can be plugged into it at any time.

#include <optional>

#include <nendo/base/side.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/range_adaptation.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/hand/slip_adaptation.hpp>

namespace nendo::hand {

/// One hand of a wearer. By default it is an average one.
struct WearerHand {
  Calibration calibration = default_calibration();
  HandSize size{};
  /// Sensors that were stuck when it was calibrated: what they measure is not used.
  SensorMask left_out{};
};

struct Wearer {
  WearerHand left;
  WearerHand right;
  /// If it is set, the ranges of the sensors are learned from a glove with such counts, and the
  /// calibrations of `left` and `right` are not used, unless there are `ends`.
  std::optional<CountScale> adapt{};
  /// What an earlier adaptation has learned; learning continues from there.
  std::optional<LearnedRanges> learned{};
  /// If it is set, only slips from the calibration of that side are learned. The other side's
  /// stays as it is.
  std::optional<CalibratedRange> ends{};
  /// If it is set, sensors of a glove with such counts that do not change while others move are
  /// left out as long as they do (stuck_watch.hpp).
  std::optional<CountScale> watched{};
  /// Sensors that an earlier watch of this glove has found stuck.
  SensorMask stuck{};

  const WearerHand& of(Side side) const noexcept { return side == Side::left ? left : right; }
  WearerHand& of(Side side) noexcept { return side == Side::left ? left : right; }
};

} // namespace nendo::hand
