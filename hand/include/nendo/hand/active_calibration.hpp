#pragma once
// Which calibration a glove's samples get, from one to the next: the wearer's; that of the other
// hand, once a glove of the other side has been plugged into the same box; or what adaptation makes
// of how the hand moves.

#include <optional>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/range_adaptation.hpp>

namespace nendo::hand {

class ActiveCalibration {
public:
  /// `own` is for samples of that side, `swapped` for the others.
  ActiveCalibration(Side side, const Calibration& own, const Calibration& swapped) noexcept
      : side_(side), own_(own), swapped_(swapped) {}
  /// Learned from the samples of a glove with such counts; goes on from `learned` if there is any.
  explicit ActiveCalibration(CountScale counts,
                             const std::optional<LearnedRanges>& learned = {}) noexcept
      : adaptation_(learned ? RangeAdaptation(counts, *learned) : RangeAdaptation(counts)) {}

  /// The calibration for this sample, the next in time; valid until the next call. Wait-free, no
  /// allocation.
  const Calibration& follow(const GloveSample& sample) noexcept {
    if (adaptation_) adaptation_->push(sample);
    return of(sample.side);
  }
  /// The calibration for a sample of that side, as things stand.
  const Calibration& of(Side side) const noexcept {
    if (adaptation_) return adaptation_->calibration();
    return side == side_ ? own_ : swapped_;
  }

  /// What was learned; null if nothing is.
  const RangeAdaptation* adaptation() const noexcept {
    return adaptation_ ? &*adaptation_ : nullptr;
  }

private:
  Side side_ = Side::right;
  Calibration own_;
  Calibration swapped_;
  std::optional<RangeAdaptation> adaptation_;
};

} // namespace nendo::hand
