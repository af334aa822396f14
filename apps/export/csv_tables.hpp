#pragma once
// Exports tables for plots. README.md describes the columns, whose names end with their units. All
// cells are numbers; values that are not finite or not known are nan.

#include <filesystem>

#include "export/chosen_frames.hpp"

namespace nendo::exporting {

/// Writes the hands' motion to `path`, with one row for each frame: the frame's columns, and then
/// those of each hand that is there, whose names begin with left_ or right_. Blocks. Errors: those
/// of ChosenFrames::next(); failed (cannot be written).
Result<Exported> export_motion_csv(ChosenFrames& frames, const std::filesystem::path& path);

/// Writes all samples of the recording `take` that came in the chosen time to `path`, atomically,
/// with one row for each sample, in the order of the recording. The angles of a hand that was not
/// calibrated (takes::is_calibrated) are nan, and so are those of sensors that the calibration does
/// not know.
/// `choice.rate_hz` must be empty. Works with and without a recorded loop. Blocks. Errors: those of
/// TakeReader::open(); bad_input (no sample in that time), failed (cannot be written, or `stop` was
/// set).
Result<Exported> export_samples_csv(const std::filesystem::path& take, const Choice& choice,
                                    const std::filesystem::path& path);

} // namespace nendo::exporting
