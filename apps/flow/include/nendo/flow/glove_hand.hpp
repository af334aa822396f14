#pragma once
// Turns one glove's samples into joint angles: calibration, sensor gate, filter, pinches.

#include <array>

#include <Eigen/Geometry>

#include <nendo/driver/sample.hpp>
#include <nendo/flow/hand_input.hpp>
#include <nendo/flow/loop_settings.hpp>
#include <nendo/flow/placement.hpp>
#include <nendo/flow/wrist_switch.hpp>
#include <nendo/hand/joint_angles.hpp>
#include <nendo/hand/joint_filter.hpp>
#include <nendo/hand/sensor_gate.hpp>
#include <nendo/hand/skeleton.hpp>
#include <nendo/hand/wearer.hpp>

namespace nendo::flow {

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
