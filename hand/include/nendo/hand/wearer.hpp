#pragma once
// The wearer of a glove: calibration and size of each of the two hands, and whether the calibration
// is learned during use. One glove box may serve both hands, since a glove of the other side can be
// plugged into it at any time.

#include <array>
#include <optional>

#include <nendo/base/side.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/hand/slip_adaptation.hpp>
#include <nendo/hand/stuck_watch.hpp>

namespace nendo::hand {

/// One hand of a wearer; by default, an average hand.
struct WearerHand {
  Calibration calibration = default_calibration();
  HandSize size{};
  /// Sensors that were stuck at calibration; their counts are not used.
  SensorMask left_out{};
};

struct Wearer {
  WearerHand left;
  WearerHand right;
  /// If set, the ranges of the sensors are learned from a glove of this scale, and the calibrations
  /// of `left` and `right` are not used, unless `ends` is set.
  std::optional<CountScale> adapt{};
  /// The state of an earlier adaptation, from which learning continues.
  std::optional<LearnedRanges> learned{};
  /// If set, only the slips of that side's calibration are learned. The other side's is constant.
  std::optional<CalibratedRange> ends{};
  /// If set, stuck sensors of a glove of this scale are left out as long as they are stuck
  /// (stuck_watch.hpp).
  std::optional<CountScale> watched{};
  /// Sensors that an earlier watch of this glove has found stuck.
  SensorMask stuck{};

  const WearerHand& of(Side side) const noexcept { return side == Side::left ? left : right; }
  WearerHand& of(Side side) noexcept { return side == Side::left ? left : right; }
};

/// Chooses the calibration for each of a glove's samples: that of the wearer's left or right hand,
/// by the side of the sample, or one that adaptation learns from the hand's movements: the whole
/// calibration, or only its slips.
class ActiveCalibration {
public:
  explicit ActiveCalibration(const Wearer& wearer) noexcept
      : left_(wearer.left.calibration), right_(wearer.right.calibration),
        left_out_{wearer.left.left_out, wearer.right.left_out} {
    if (wearer.watched) stuck_.emplace(*wearer.watched, wearer.stuck);
    if (!wearer.adapt) return;
    if (wearer.ends) {
      const Calibration& made = wearer.of(wearer.ends->side).calibration;
      slips_ = wearer.learned ? SlipAdaptation(made, *wearer.ends, *wearer.adapt, *wearer.learned)
                              : SlipAdaptation(made, *wearer.ends, *wearer.adapt);
    } else if (wearer.learned) {
      ranges_.emplace(*wearer.adapt, *wearer.learned);
    } else {
      ranges_.emplace(*wearer.adapt);
    }
  }

  /// Returns the calibration for this sample, which must be the next in time order. The reference
  /// is valid until the next call. Wait-free, no allocation.
  const Calibration& follow(const GloveSample& sample) noexcept {
    if (ranges_) ranges_->push(sample);
    if (slips_) slips_->push(sample);
    if (stuck_) stuck_->push(sample);
    return of(sample.side);
  }
  /// Returns the current calibration of that side, without learning.
  const Calibration& of(Side side) const noexcept {
    if (ranges_) return ranges_->calibration();
    if (slips_ && slips_->side() == side) return slips_->calibration();
    return side == Side::left ? left_ : right_;
  }

  /// Returns the sensors of that side that joint_angles() must leave out: sensors that were stuck
  /// at calibration, and sensors found stuck since. Wait-free.
  SensorMask left_out(Side side) const noexcept {
    SensorMask mask = left_out_[side == Side::left ? 0 : 1];
    if (stuck_ && stuck_->side() == side) mask.bits |= stuck_->stuck().bits;
    return mask;
  }
  /// Returns the sensors of `sample` that must be left out. Wait-free.
  SensorMask left_out(const GloveSample& sample) const noexcept {
    return {left_out(sample.side).bits & sample.present.bits};
  }
  /// Returns the watch for stuck sensors, or null if there is none.
  const StuckWatch* stuck() const noexcept { return stuck_ ? &*stuck_ : nullptr; }

  /// Returns the learner of the whole calibration, or null if there is none.
  const RangeAdaptation* adaptation() const noexcept { return ranges_ ? &*ranges_ : nullptr; }
  /// Returns the learner of the calibration's slips, or null if there is none.
  const SlipAdaptation* slips() const noexcept { return slips_ ? &*slips_ : nullptr; }
  /// Returns the state from which learning can continue; nullopt if no learner has one.
  std::optional<LearnedRanges> learned() const noexcept {
    if (slips_) return slips_->learned();
    return ranges_ ? ranges_->learned() : std::nullopt;
  }

private:
  Calibration left_;
  Calibration right_;
  std::array<SensorMask, 2> left_out_; ///< at calibration: left, right
  std::optional<StuckWatch> stuck_;
  std::optional<RangeAdaptation> ranges_;
  std::optional<SlipAdaptation> slips_;
};

} // namespace nendo::hand
