#pragma once
// Exports what gloves sent as a table, with one row for each recorded sample, in the order of the
// recording. README.md describes the columns. All cells are numbers; what a glove does not tell is
// nan, and so are the angles of a hand that was not calibrated (takes::is_calibrated) and of
// sensors that the calibration does not know.

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
