#pragma once
// The angles of a hand's joints, made from one glove sample. Stated rules fill in what a glove does
// not measure.

#include <array>

#include <nendo/driver/sample.hpp>
#include <nendo/hand/angle.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/joints.hpp>

namespace nendo::hand {

/// The angles of the index, middle, ring or little finger. Flexion > 0 bends towards the palm;
/// abduction > 0 turns towards the thumb.
struct FingerAngles {
  double mcp_flexion_rad = 0.0;
  double mcp_abduction_rad = 0.0;
  double pip_flexion_rad = 0.0;
  double dip_flexion_rad = 0.0;
};

/// The angles of all joints. All zero is the flat hand with closed fingers and the thumb beside the
/// index finger.
struct NENDO_API JointAngles {
  double thumb_roll_rad = 0.0;      ///< > 0 carries the thumb across in front of the palm
  double thumb_abduction_rad = 0.0; ///< > 0 opens the web between thumb and index finger
  double thumb_mcp_flexion_rad = 0.0;
  double thumb_ip_flexion_rad = 0.0;
  std::array<FingerAngles, 4> fingers{}; ///< index, middle, ring, little
  double palm_arch_rad = 0.0;   ///< > 0 brings the little finger's metacarpal towards the thumb
  double wrist_pitch_rad = 0.0; ///< > 0 flexes the hand towards the palm
  double wrist_yaw_rad = 0.0;   ///< > 0 turns the hand towards the thumb (radial)

  FingerAngles& operator[](Finger finger) noexcept {
    return fingers[static_cast<std::size_t>(finger) - 1];
  }
  const FingerAngles& operator[](Finger finger) const noexcept {
    return fingers[static_cast<std::size_t>(finger) - 1];
  }
  double& operator[](Angle angle) noexcept;
  const double& operator[](Angle angle) const noexcept;
};

/// Applies the calibration and keeps every angle within its joint's range of motion by soft stops
/// (joint_limits.hpp). The abduction sensors measure pairs of fingers. None measures the middle
/// finger's own abduction; it follows from the pairs by the calibration's middle bias, and is
/// usually 0.
///
/// Angles of absent sensors are estimated from present ones, by rules that are continuous and do
/// not fall when a measured angle rises; angle_sources.hpp says which angles are estimated:
/// - finger DIP: 0.32 PIP^2 + 0.17 PIP, of a bent PIP (the vendor library's rule for 18-sensor
///   gloves);
/// - finger PIP: 1.1 MCP, of a bent MCP. A glove with one sensor a finger measures curl, and in a
///   closing hand both joints arrive together, at about 100 and 90 degrees;
/// - finger MCP: the measured PIP / 1.1, for the same reason;
/// - thumb IP: 0.5 MCP, of a bent MCP; thumb MCP: 2 times the measured IP. In a pinch the IP joint
///   bends about half as much, and pulp meets pulp;
/// - thumb roll and abduction: from 20 degrees each, as a hand at rest has them, to 30 and 35 with
///   the thumb bent by 55 degrees (MCP). So a thumb that has one sensor opposes the index finger as
///   it bends: its tip comes within 5 mm of the path of a curling index finger's;
/// - all others, and a thumb without any flexion sensor: zero, that is closed fingers, a flat palm,
///   a straight wrist.
/// Angles of sensors that are present but `left_out`, because they are stuck, are estimated from
/// more: from the same joints of the fingers beside, and where nothing determines them, they are
/// those of a hand at rest.
/// Wait-free; the result is finite.
NENDO_API JointAngles joint_angles(const GloveSample& sample, const Calibration& calibration,
                                   SensorMask left_out = {}) noexcept;

/// Returns the angles of all sensors in a glove on a hand with these joints. joint_angles() turns
/// them into `joints`, if the middle finger does not turn aside, which no glove measures.
/// Wait-free.
NENDO_API SensorAngles sensor_angles_of(const JointAngles& joints) noexcept;

/// Returns Calibration::angles_rad(), where the angles of sensors that are `left_out` follow from
/// the others: a finger's flexion from the same joints beside it and from its own other joints, a
/// gap from the other gaps, the thumb's flexion from its other one; and where nothing determines
/// them, as of a hand at rest. Without any left out it returns the same bits as that. Wait-free;
/// finite if the measured angles are.
NENDO_API SensorAngles filled_angles_rad(const GloveSample& sample, const Calibration& calibration,
                                         SensorMask left_out) noexcept;

} // namespace nendo::hand
