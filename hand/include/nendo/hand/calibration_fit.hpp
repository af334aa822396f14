#pragma once
// Fits a wearer's calibration to held poses: finds the line of each sensor and the couplings under
// which the poses are likeliest, by the method of Levenberg and Marquardt. The fit rests on the
// angles that a pose is known to have, each as sure as wearers are at it, and some shifted by a
// habit that all poses share. It also rests on touches, where the pads of the thumb and of a finger
// meet by forward kinematics, whatever the angles (closed loops; Griffin, Findley, Turner, Cutkosky
// 2000), on the ends of a free motion, and, very softly, on the default calibration. What the poses
// do not determine stays at the default and is reported as undetermined.
//
// The hand is unknown: its size, its bones, the base and the axes of the thumb, and the tilt
// of the knuckles are fitted with the sensors, each as far as published hands differ. So a touch
// teaches mostly the hand where that is uncertain, and angles where it is known.

#include <array>
#include <optional>
#include <span>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/joints.hpp>
#include <nendo/hand/pose_capture.hpp>
#include <nendo/hand/range_capture.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

/// Returns the sensors of a finger's joints, with those of the gaps beside it. Wait-free.
NENDO_API SensorMask sensors_of(Finger finger) noexcept;

struct PoseReading {
  PoseId pose = PoseId::flat;
  HeldPose held;
};

enum class FitMode : std::uint8_t {
  /// Fits a line for each flexion sensor, and for the other sensors only the offset, from the flat
  /// hand. Uses no couplings and no touches. That is all that two poses can determine.
  quick,
  full,
  /// Fits only how far each sensor has slipped since FitOptions::start was made, from a flat hand,
  /// a fist and touches, and from how the ends of a free motion have moved. How far sensors slip on
  /// the whole is found first, so that poses held badly do not pass for slips.
  touch_up,
};

struct FitOptions {
  CountScale scale{};
  FitMode mode = FitMode::full;
  /// The hand before it is fitted. With `size_known`, its length and breadth are measured, and not
  /// fitted. In a touch-up all of it is kept.
  HandSize size{};
  bool size_known = false;
  /// Sensors of joints that cannot do the poses. Of them only what the flat hand says is believed,
  /// and no touch of their fingers; gains stay the default's where nothing else determines them.
  SensorMask stiff{};
  /// The calibration that is touched up; needed for that alone.
  std::optional<Calibration> start{};
  /// The ends that its sensors reached then (reached_ends()); empty where they are not known.
  CountRanges start_ends{};
  /// Compares the full fit with the quick one by poses that are held out (see
  /// CalibrationFit::uses_quick_fit). It takes as long again as the fit.
  bool hold_out = true;
  /// The ranges of a free motion in which every joint went from end to end; empty without one. A
  /// sensor that reached less there than in the poses is taken not to have been at its end.
  CountRanges free_motion{};
};

struct SensorFit {
  bool gain_determined = false;
  bool offset_determined = false;
  double low_counts = 0.0; ///< the range that the poses covered
  double high_counts = 0.0;
  double residual_rad = 0.0; ///< root mean square, over poses that assume an angle
  /// The standard deviation of the angle within that range, root mean square over the poses. It
  /// follows from the deviations that the poses assume, and from the default's where the default
  /// was kept.
  double deviation_rad = 0.0;
};

struct ReadingFit {
  double misfit = 0.0; ///< root mean square of residuals over their deviations; about 1 is usual
  double gap_m = 0.0;  ///< between the pads that should touch; 0 in poses without touch
};

/// Evidence that contradicts the rest so much that it was not used.
struct SetAside {
  std::size_t reading = 0;      ///< its place among those given
  std::optional<Sensor> sensor; ///< whose assumed angle it was; nullopt: the touch
};

struct CalibrationFit {
  Calibration calibration;
  HandSize size; ///< this wearer's hand
  /// Root mean square distance between the pads that touched, under the fit; 0 without touches.
  double touch_residual_m = 0.0;
  std::vector<SetAside> set_aside;
  /// Sensors whose lines are those of the quick fit, because these predict the held-out
  /// poses better than those of the full fit. They are chosen by groups of like joints.
  SensorMask uses_quick_fit;
  std::array<SensorFit, sensor_slots> sensors{};
  /// Fingers, thumb to little finger, whose joints moved so much less than the poses ask
  /// that their gains are implausible for a glove: they may be stiff (FitOptions::stiff).
  std::array<bool, finger_count> limited_range{};
  SensorMask undetermined; ///< sensors that are present, whose gain or offset is the default's
  std::vector<ReadingFit> readings; ///< in the order of those given
  /// Ratio of the largest singular value of the determined problem to its smallest, in units of
  /// the default's deviation.
  double condition = 1.0;
};

/// Fits the calibration of a glove with these sensors on this side. `readings` must contain flat
/// and fist, and may contain a pose several times; their order does not matter. The middle bias
/// stays at its default, because no pose shows it. Takes some hundred milliseconds and allocates.
/// Fails with bad_input on: a reading that is not finite, out of scale, saturated or lacks a
/// sensor; flat or fist missing; a sensor of a finger's first two joints that moves the wrong way
/// or not at all. Other contradictions are no errors; their evidence is set aside.
NENDO_API Result<CalibrationFit> fit_calibration(std::span<const PoseReading> readings, Side side,
                                                 SensorMask sensors,
                                                 const FitOptions& options = {});

} // namespace nendo::hand
