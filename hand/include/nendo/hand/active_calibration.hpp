#pragma once
// Chooses the calibration for each of a glove's samples: that of the wearer's left or right hand,
// whichever glove sent the sample, or the one that adaptation learns from how the hand moves.

#include <optional>

#include <nendo/hand/wearer.hpp>

namespace nendo::hand {

class ActiveCalibration {
public:
  explicit ActiveCalibration(const Wearer& wearer) noexcept
      : left_(wearer.left.calibration), right_(wearer.right.calibration) {
    if (!wearer.adapt) return;
    if (wearer.learned) {
      adaptation_.emplace(*wearer.adapt, *wearer.learned);
    } else {
      adaptation_.emplace(*wearer.adapt);
    }
  }

  /// Returns the calibration for this sample, which must be the next in time. The reference is
  /// valid until the next call. Wait-free, no allocation.
  const Calibration& follow(const GloveSample& sample) noexcept {
    if (adaptation_) adaptation_->push(sample);
    return of(sample.side);
  }
  /// Returns the calibration for a sample of that side without learning from one.
  const Calibration& of(Side side) const noexcept {
    if (adaptation_) return adaptation_->calibration();
    return side == Side::left ? left_ : right_;
  }

  /// Returns what is being learned, or null if the wearer's calibrations are used.
  const RangeAdaptation* adaptation() const noexcept {
    return adaptation_ ? &*adaptation_ : nullptr;
  }

private:
  Calibration left_;
  Calibration right_;
  std::optional<RangeAdaptation> adaptation_;
};

} // namespace nendo::hand
