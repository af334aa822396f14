#pragma once
// What is known of the person who wears a glove: for each of the two hands its calibration and its
// size, and whether the calibration is to be learned while the glove is used. One glove box may see
// both hands, since a glove of the other side can be plugged into it at any time.

#include <array>
#include <optional>

#include <nendo/base/side.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/range_adaptation.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/hand/stuck_watch.hpp>

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

// Chooses the calibration for each of a glove's samples: that of the wearer's left or right hand,
// whichever glove sent the sample, or what adaptation learns from how the hand moves: the whole
// calibration, or how far it has slipped.
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

  /// Returns the calibration for this sample, which must be the next in time. The reference is
  /// valid until the next call. Wait-free, no allocation.
  const Calibration& follow(const GloveSample& sample) noexcept {
    if (ranges_) ranges_->push(sample);
    if (slips_) slips_->push(sample);
    if (stuck_) stuck_->push(sample);
    return of(sample.side);
  }
  /// Returns the calibration for a sample of that side without learning from one.
  const Calibration& of(Side side) const noexcept {
    if (ranges_) return ranges_->calibration();
    if (slips_ && slips_->side() == side) return slips_->calibration();
    return side == Side::left ? left_ : right_;
  }

  /// Returns the sensors of that side that are to be left out: those that were stuck when it was
  /// calibrated, and those that have been found since (joint_angles() takes them). Wait-free.
  SensorMask left_out(Side side) const noexcept {
    SensorMask mask = left_out_[side == Side::left ? 0 : 1];
    if (stuck_ && stuck_->side() == side) mask.bits |= stuck_->stuck().bits;
    return mask;
  }
  /// Returns those of the sample's own sensors that are to be left out. Wait-free.
  SensorMask left_out(const GloveSample& sample) const noexcept {
    return {left_out(sample.side).bits & sample.present.bits};
  }
  /// Returns what watches for stuck sensors, or null if nothing does.
  const StuckWatch* stuck() const noexcept { return stuck_ ? &*stuck_ : nullptr; }

  /// Returns what is being learned in place of a calibration, or null if nothing is.
  const RangeAdaptation* adaptation() const noexcept { return ranges_ ? &*ranges_ : nullptr; }
  /// Returns what is being learned of a calibration's slips, or null if nothing is.
  const SlipAdaptation* slips() const noexcept { return slips_ ? &*slips_ : nullptr; }
  /// Returns the state from which learning can continue; nullopt if nothing is being learned yet.
  std::optional<LearnedRanges> learned() const noexcept {
    if (slips_) return slips_->learned();
    return ranges_ ? ranges_->learned() : std::nullopt;
  }

private:
  Calibration left_;
  Calibration right_;
  std::array<SensorMask, 2> left_out_; ///< left and right calibration's
  std::optional<StuckWatch> stuck_;
  std::optional<RangeAdaptation> ranges_;
  std::optional<SlipAdaptation> slips_;
};

} // namespace nendo::hand
