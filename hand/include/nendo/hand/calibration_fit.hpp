#pragma once
// A wearer's calibration from held poses: the line of each sensor and the couplings under which the
// poses are likeliest, by Levenberg and Marquardt. Four things speak: the angles that a pose is
// known to have, each as surely as wearers do it, some by a habit that all poses share; touches,
// where the thumb's and a finger's pads meet by forward kinematics, whatever the angles (closed
// loops; Griffin, Findley, Turner, Cutkosky 2000); the ends of a free motion; and the default
// calibration, very softly. What the poses do not determine is left at the default and said to be
// undetermined.

#include <array>
#include <span>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/hand/calibration.hpp>
#include <nendo/hand/calibration_poses.hpp>
#include <nendo/hand/pose_capture.hpp>
#include <nendo/hand/range_capture.hpp>
#include <nendo/hand/skeleton.hpp>

namespace nendo::hand {

struct PoseReading {
  PoseId pose = PoseId::flat;
  HeldPose held;
};

enum class FitMode : std::uint8_t {
  /// A line for each flexion sensor; of the others the offset, from the flat hand. No couplings, no
  /// touches. All that two poses can say.
  quick,
  full,
};

struct FitOptions {
  CountScale scale{};
  FitMode mode = FitMode::full;
  /// Not fitted: touches close at the same angles in a larger hand, up to the pads' thickness.
  HandSize size{};
  /// Of a free motion in which every joint went from end to end; empty without one. A sensor that
  /// reached less there than in the poses is taken not to have been at its end.
  CountRanges free_motion{};
};

/// What became of a sensor.
struct SensorFit {
  bool gain_determined = false;
  bool offset_determined = false;
  double low_counts = 0.0; ///< the range that the poses covered
  double high_counts = 0.0;
  double residual_rad = 0.0; ///< root mean square, over poses that assume an angle
  /// How sure the angle is within that range: a standard deviation, root mean square over the
  /// poses. It rests on what the poses say of themselves, and on the default where it was kept.
  double deviation_rad = 0.0;
};

/// How well one reading agrees with the calibration.
struct ReadingFit {
  double misfit = 0.0; ///< root mean square of residuals over their deviations; about 1 is usual
  double gap_m = 0.0;  ///< between the pads that should touch; 0 in poses without touch
};

struct CalibrationFit {
  Calibration calibration;
  std::array<SensorFit, sensor_slots> sensors{};
  std::array<bool, couplings.size()> coupling_determined{};
  SensorMask undetermined; ///< sensors that are present, whose gain or offset is the default's
  std::vector<ReadingFit> readings; ///< in the order of those given
  /// Ratio of the largest singular value of the determined problem to its smallest, in units of
  /// what the default leaves open.
  double condition = 1.0;
};

/// Fits the calibration of a glove with these sensors on this side. `readings` need flat and fist,
/// and may hold a pose several times; their order is of no consequence. The middle bias stays at
/// its default, because no pose shows it. Takes milliseconds, allocates. Errors: a reading that is
/// not finite, out of scale, saturated or lacks a sensor; flat or fist missing; a sensor that moves
/// the wrong way, or whose poses contradict each other.
Result<CalibrationFit> fit_calibration(std::span<const PoseReading> readings, Side side,
                                       SensorMask sensors, const FitOptions& options = {});

} // namespace nendo::hand
