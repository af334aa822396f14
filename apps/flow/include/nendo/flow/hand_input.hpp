#pragma once
// An input of the loop: a glove's ring, its wearer's calibration, and the filter of its samples. It
// turns samples into joint angles: calibration, sensor gate, filter, pinches.

#include <array>
#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>
#include <nendo/driver/sample.hpp>
#include <nendo/flow/layer.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/flow/wrist.hpp>
#include <nendo/hand/active_calibration.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/hand/sensor_gate.hpp>
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

/// Loop's thread. Only the constructor allocates.
struct NENDO_API GloveHand {
  GloveHand(HandInput hand_input, const Placement& placement, bool closes);

  /// Updates `latest` and `angles` by the next sample. Returns true if the switch at the wrist was
  /// just turned on.
  bool update(const GloveSample& sample) noexcept;
  /// Changes the filter, where it differs, and whether pinches are closed.
  void change_filter(const hand::FilterOptions& options, bool closes) noexcept;
  /// Forgets all that came before `latest` but what adaptation has learned.
  void restart() noexcept;

  const hand::HandSkeleton& skeleton() const noexcept {
    return skeletons[Placement::index_of(latest.side)];
  }
  /// Returns the sensors of `latest` that are stuck.
  SensorMask left_out() const noexcept {
    return {calibration.left_out(latest.side).bits & latest.present.bits};
  }

  HandInput input;
  std::size_t slot; ///< in arrays by side
  Eigen::Isometry3d T_stage_wrist;
  std::array<hand::HandSkeleton, 2> skeletons; ///< in the order of the glove's side
  hand::ActiveCalibration calibration;
  hand::SensorGate gate{};
  hand::JointFilter filter;
  GloveSample latest{};
  bool closes_pinches;        ///< the filter's options say so, and nothing is between the pads
  hand::JointAngles angles{}; ///< those of `latest`, filtered, with pinches closed
  WristSwitchEdge wrist_switch{};
  bool is_lowest = true;  ///< the hand of its side, and not a layer over it
  bool is_topmost = true; ///< the last layer of its side, whose samples are counted
  bool fresh = false;     ///< samples came out of its ring in this tick
  bool silent = false;

private:
  void follow(const GloveSample& sample) noexcept;
  void pose_by(const hand::Calibration& active) noexcept;
};

} // namespace nendo::flow
