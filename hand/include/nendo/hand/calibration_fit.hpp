#pragma once
// Fits a wearer's calibration to held poses: the maximum a posteriori estimate of the line of each
// sensor and the couplings, by the Levenberg-Marquardt method. The evidence is: the assumed angles
// of each pose, weighted by the deviations of wearers, some with a bias that all poses share;
// touches, where the pads of the thumb and of a finger coincide by forward kinematics (closed
// loops; Griffin, Findley, Turner, Cutkosky 2000); the ends of a free motion; and, with a low
// weight, the default calibration. Parameters that the poses do not determine stay at the default
// and are reported as undetermined.
//
// The hand's size, its bones, the base and the axes of the thumb, and the tilts of the knuckles are
// fitted with the sensors, with priors from published variation. A touch thus mostly determines the
// hand where that is uncertain, and angles where it is known.

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

/// Returns the sensors of a finger's joints and of the gaps beside it. Wait-free.
NENDO_API SensorMask sensors_of(Finger finger) noexcept;

struct PoseReading {
  PoseId pose = PoseId::flat;
  HeldPose held;
};

enum class FitMode : std::uint8_t {
  /// Fits a line for each flexion sensor, and for the other sensors only the offset, from the flat
  /// hand. Uses no couplings and no touches. Two poses determine no more.
  quick,
  full,
  /// Fits only the slip of each sensor since FitOptions::start was made, from a flat hand, a fist,
  /// touches, and the shifts of the ends of a free motion. The typical size of slips is estimated
  /// first, so that badly held poses are not taken for slips.
  touch_up,
};

struct FitOptions {
  CountScale scale{};
  FitMode mode = FitMode::full;
  /// The initial hand. With `size_known`, its length and breadth are measured, and not fitted. A
  /// touch-up keeps all of it.
  HandSize size{};
  bool size_known = false;
  /// Sensors of joints that cannot take the poses. Only their readings of the flat hand are used,
  /// and no touches of their fingers; gains stay the default's if nothing else determines them.
  SensorMask stiff{};
  /// The calibration to touch up; needed only in this mode.
  std::optional<Calibration> start{};
  /// The ends that sensors reached for `start` (reached_ends()); empty if unknown.
  CountRanges start_ends{};
  /// Cross-validates the full against the quick fit by held-out poses (see
  /// CalibrationFit::uses_quick_fit). This doubles the time of the fit.
  bool hold_out = true;
  /// The ranges of a free motion in which every joint went from end to end; empty without one. A
  /// sensor that reached less there than in the poses is assumed not to have reached its end.
  CountRanges free_motion{};
};

struct SensorFit {
  bool gain_determined = false;
  bool offset_determined = false;
  double low_counts = 0.0; ///< the range that the poses covered
  double high_counts = 0.0;
  double residual_rad = 0.0; ///< root mean square, over poses that assume an angle
  /// The standard deviation of the angle within that range, root mean square over the poses. It is
  /// propagated from the assumed deviations of the poses, and from the default's where that was
  /// kept.
  double deviation_rad = 0.0;
};

struct ReadingFit {
  double misfit = 0.0; ///< root mean square of normalized residuals; about 1 is usual
  double gap_m = 0.0;  ///< distance of pads that should touch; 0 without touch
};

/// An outlier: rejected evidence that contradicts the rest.
struct Outlier {
  std::size_t reading = 0;      ///< index in `readings`
  std::optional<Sensor> sensor; ///< the sensor of the assumed angle; nullopt: the touch
};

struct CalibrationFit {
  Calibration calibration;
  HandSize size; ///< this wearer's hand
  /// Root mean square distance between the pads that touched, under the fit; 0 without touches.
  double touch_residual_m = 0.0;
  std::vector<Outlier> outliers;
  /// Sensors with lines of the quick fit, which predict the held-out poses better than the full
  /// fit. Chosen per group of similar joints.
  SensorMask uses_quick_fit;
  std::array<SensorFit, sensor_slots> sensors{};
  /// Fingers, thumb to little finger, whose joints moved so much less than the poses require that
  /// the gains are implausible: they may be stiff (FitOptions::stiff).
  std::array<bool, finger_count> limited_range{};
  SensorMask undetermined;          ///< present sensors with the default's gain or offset
  std::vector<ReadingFit> readings; ///< in the order of the argument
  /// Condition number of the determined problem, in units of the default's deviation.
  double condition = 1.0;
};

/// Fits the calibration of a glove with these sensors on this side. `readings` must contain flat
/// and fist, and may contain a pose several times; their order does not matter. The middle bias
/// stays at its default, because no pose determines it. Takes some hundred milliseconds and
/// allocates. Fails with bad_input on: a reading that is not finite, out of scale, saturated or
/// lacks a sensor; flat or fist missing; an MCP or PIP sensor of a finger that moves the wrong way
/// or not at all. Other contradictions are no errors; see CalibrationFit::outliers.
NENDO_API Result<CalibrationFit> fit_calibration(std::span<const PoseReading> readings, Side side,
                                                 SensorMask sensors,
                                                 const FitOptions& options = {});

} // namespace nendo::hand
