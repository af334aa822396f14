#pragma once
// Samples of gloves and poses of trackers as structured arrays.

#include <cstdint>
#include <vector>

#include <pybind11/numpy.h>

#include <nendo/driver/pose_sample.hpp>
#include <nendo/driver/sample.hpp>

#include "python/bind.hpp"

namespace nendo::python {

// Without padding, which NumPy removes when it concatenates arrays, and then sees another type.

/// A row of an array of samples. Times are seconds by time.monotonic(), which is HostClock.
struct SampleRow {
  double time_s, arrival_s, device_s;
  std::uint64_t sequence;
  std::uint16_t counts[sensor_slots];
  bool present[sensor_slots];
  std::int32_t side;         ///< 0 left, 1 right
  std::int16_t wrist_switch; ///< -1 unknown, 0 off, 1 on
  bool sampled_too_fast;
  bool is_replayed;
};

/// A row of an array of a tracker's poses.
struct PoseRow {
  double time_s, arrival_s, device_s;
  std::uint64_t sequence;
  double position_m[3];
  double turn_xyzw[4];
  std::int32_t station;
  char error[4]; ///< one letter
};

static_assert(sizeof(SampleRow) == 112 && sizeof(PoseRow) == 96); // the sums of their fields

py::array array_of(const std::vector<GloveSample>& samples);
py::array array_of(const std::vector<PoseSample>& poses);
/// Returns the samples of such an array. Throws TypeError or ValueError.
std::vector<GloveSample> samples_of(const py::handle& array, const char* name);

} // namespace nendo::python
