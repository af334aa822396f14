#pragma once
// Exports the hands' motion as a table for plots, with one row for each frame. README.md describes
// the columns, whose names end with their units: those of the frame, and then those of each hand
// that is there, whose names begin with left_ or right_. All cells are numbers; what is not finite
// or not known is nan.

#include <filesystem>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// Writes the table to `path`. Blocks. Errors: those of ChosenFrames::next(); failed (cannot be
/// written).
Result<Exported> export_motion_csv(ChosenFrames& frames, const std::filesystem::path& path);

} // namespace nendo::exporting
