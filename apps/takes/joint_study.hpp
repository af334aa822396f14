#pragma once
// How the joints of a recorded hand moved: how far, how steadily measured, and which ones together.
// So one sees whether a recording, a glove or a calibration agrees with what anatomy says.

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/base/side.hpp>
#include <nendo/hand/angle_sources.hpp>
#include <nendo/hand/joint_angles.hpp>

namespace nendo::takes {

/// Of a joint angle, in radians.
struct JointRange {
  hand::AngleSource source = hand::AngleSource::zero;
  double min_rad = 0.0, max_rad = 0.0;
  double low_rad = 0.0, median_rad = 0.0, high_rad = 0.0; ///< 5th, 50th and 95th percentiles
  double beyond = 0.0; ///< part of the samples outside the published range (joint_limits.hpp)
  /// What differs from sample to sample while the joint rests: root mean square of white noise with
  /// the same second differences, in the calmest quarter of the recording.
  double noise_rad = 0.0;
};

/// Two angles that move together.
struct JointPair {
  hand::Angle one, other;
  std::optional<double> published_slope{};
  double correlation = 0.0; ///< Pearson's
  double slope = 0.0;       ///< slope of `other` over `one`
};

struct JointStudy {
  Side side = Side::right;
  bool is_calibrated = false; ///< otherwise the angles are an average hand's
  std::size_t samples = 0;
  double duration_s = 0.0;
  std::array<JointRange, hand::angle_count> ranges{}; ///< indexed by hand::index_of()
  /// Neighbouring joints of a finger, and the same joint of neighbouring fingers; of measured
  /// angles that moved.
  std::vector<JointPair> pairs;
  /// Parts of the variance of the measured angles of thumb and fingers that the first one, two, ...
  /// principal components hold together; empty if nothing moved.
  std::vector<double> components;
};

/// Studies each glove of a recording, with the calibration with which it was recorded. Blocks.
/// Errors: those of TakeReader::open(); bad_input (no sample).
Result<std::vector<JointStudy>> study_joints(const std::filesystem::path& path);

/// Studies angles that were sampled evenly, as from a glove with these sensors, some of which were
/// left out. For tests, and for angles from elsewhere.
JointStudy study_joints(const std::vector<hand::JointAngles>& angles, SensorMask sensors,
                        SensorMask left_out = {});

/// Prints a table of joints, pairs of joints, and principal components of each hand, beside what is
/// published of them.
void print_joints(const std::string& file, const std::vector<JointStudy>& studies);
/// Prints the same as one JSON object.
void print_joints_json(const std::string& file, const std::vector<JointStudy>& studies);

} // namespace nendo::takes
