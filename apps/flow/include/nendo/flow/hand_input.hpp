#pragma once
// An input of the loop: a glove's ring, its wearer's calibration, and the filter of its samples.

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/layer.hpp>
#include <nendo/flow/wrist_path.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/hand/wearer.hpp>

namespace nendo::flow {

/// A hand as an input of the loop, or a layer over it. Only the loop's thread drains `ring`, which
/// must outlive the loop; without one, the input is in LoopOptions::script.
struct HandInput {
  SampleRing* ring = nullptr;
  Side side = Side::right; ///< which hand it is on the stage, whichever glove it wears
  hand::Wearer wearer;
  GloveSample first;            ///< the pose in which the hand grabs the model
  bool gated = true;            ///< hand::SensorGate keeps out counts that no hand can have caused
  hand::FilterOptions filter{}; ///< filters the joint angles, at the samples' own times
  /// Measured bones (HandSkeleton::of_bones) for gloves of the first sample's side, in place of the
  /// wearer's size. A recording does not keep them.
  std::optional<hand::HandSkeleton> measured{};
  /// A layer has its own glove and calibration; the hand's bones are those of the first input of
  /// its side.
  std::optional<Layer> layer{};
  /// Where the wrist of a simulated hand is, by its glove's own time. The loop moves the wrist with
  /// each sample as a WristMove does, which a recording keeps.
  std::shared_ptr<const WristPath> wrist_path{};

  /// Returns the skeleton for samples from a glove of that side. It always has the side `side`.
  hand::HandSkeleton skeleton(Side glove) const {
    if (measured && glove == first.side) return *measured;
    return hand::HandSkeleton(side, wearer.of(glove).size);
  }
};

/// Checks that a loop can be made of these: one to max_inputs, and of each side at most one that
/// is no layer, before its layers. Error: bad_input, naming the input that is wrong.
NENDO_API Result<void> check_inputs(std::span<const HandInput> inputs);
/// Returns how many hands shape: one or two.
NENDO_API std::size_t count_hands(std::span<const HandInput> inputs) noexcept;

} // namespace nendo::flow
