#pragma once
// Exports what gloves sent as a table, with one row for each recorded sample, in the order of the
// recording. The columns are:
//
// - time_s and measured_s: when the sample came and when the glove took it, by the host's clock,
//   since the recording began. The first samples came a little before that.
// - device_time_s: the glove's own clock, if it has one.
// - hand, sequence, and switch (on, off, or empty if the glove does not tell).
// - SENSOR_count for each sensor that any of the gloves has, and then SENSOR_deg. Angles are those
//   of the calibration with which the hand was recorded. They are empty for a hand that was not
//   calibrated (takes::is_calibrated) and for sensors that the calibration does not know.

#include <filesystem>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// Writes all samples of the recording `take` that came in the chosen time to `path`, atomically.
/// `choice.rate_hz` must be empty. Works with and without a recorded loop. Blocks. Errors: those of
/// TakeReader::open(); bad_input (no sample in that time), failed (cannot be written, or `stop` was
/// set).
Result<Exported> export_samples_csv(const std::filesystem::path& take, const Choice& choice,
                                    const std::filesystem::path& path);

} // namespace nendo::exporting
