#pragma once
// The angles of a hand's joints, made from one glove sample. Rules estimate the angles that a glove
// does not measure.

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

  double flexion_rad() const noexcept {
    return mcp_flexion_rad + pip_flexion_rad + dip_flexion_rad;
  }
};

/// The angles of all joints. All zero is the flat hand with closed fingers and the thumb beside the
/// index finger.
struct NENDO_API JointAngles {
  double thumb_roll_rad = 0.0;      ///< > 0 moves the thumb across, in front of the palm
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
  /// Returns the sum of the flexions of a finger, or of the thumb.
  double flexion_rad(Finger finger) const noexcept {
    if (finger == Finger::thumb) return thumb_mcp_flexion_rad + thumb_ip_flexion_rad;
    return (*this)[finger].flexion_rad();
  }
  double& operator[](Angle angle) noexcept;
  const double& operator[](Angle angle) const noexcept;
};

/// Applies the calibration and keeps every angle within its joint's range of motion by soft stops
/// (joint_limits.hpp). The abduction sensors measure angles between two fingers. None measures the
/// middle finger's own abduction; it follows from Calibration::middle_bias, and is usually 0.
///
/// Angles of absent sensors are estimated from present ones, by rules that are continuous and
/// non-decreasing; angle_sources() returns which angles are estimated:
/// - finger DIP: 0.32 PIP^2 + 0.17 PIP, if the PIP is bent (the vendor library's rule for 18-sensor
///   gloves);
/// - finger PIP: 1.1 MCP, if the MCP is bent. With one sensor per finger, a glove measures curl,
///   and in a closing hand both joints reach their ends together, at about 100 and 90 degrees;
/// - finger MCP: the measured PIP / 1.1, for the same reason;
/// - thumb IP: 0.5 MCP, if the MCP is bent; thumb MCP: 2 times the measured IP. In a pinch of two
///   pads, the IP joint bends about half as much as the MCP joint;
/// - thumb roll and abduction: from 20 degrees each, as in a hand at rest, to 30 and 35 at 55
///   degrees of MCP flexion. A thumb with one sensor thus opposes the index finger as it bends: its
///   tip comes within 5 mm of the path of a curling index finger's tip;
/// - all others, and a thumb without any flexion sensor: zero, that is closed fingers, a flat palm,
///   a straight wrist.
/// Angles of sensors that are present but stuck (`left_out`) are also estimated from the same
/// joints of neighbouring fingers; if nothing determines them, they are those of a hand at rest.
/// Wait-free; the result is finite.
NENDO_API JointAngles joint_angles(const GloveSample& sample, const Calibration& calibration,
                                   SensorMask left_out = {}) noexcept;

/// Returns the angles of all sensors on a hand with these joint angles. It inverts joint_angles(),
/// except for the middle finger's abduction, which no glove measures. Wait-free.
NENDO_API SensorAngles sensor_angles_of(const JointAngles& joints) noexcept;

/// Returns Calibration::angles_rad(), with estimates for sensors in `left_out`: a finger's flexion
/// from its other joints and from the same joints of its neighbours, a gap from the other gaps, the
/// thumb's flexion from its other flexion sensor; if nothing determines them, the angles of a hand
/// at rest. If `left_out` is empty, it returns the same bits. Wait-free; finite if the measured
/// angles are.
NENDO_API SensorAngles filled_angles_rad(const GloveSample& sample, const Calibration& calibration,
                                         SensorMask left_out) noexcept;

} // namespace nendo::hand
