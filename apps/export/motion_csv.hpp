#pragma once
// Exports the hands' motion as a table for plots, with one row for each frame. The names of the
// columns end with their units. The first columns are time_s (since the take began), tick, held (0
// or 1), commits, undos, and status (ok, merged, singular, too_dense, not_finite). Then each hand
// has columns whose names begin with left_ or right_: samples, silent (0 or 1), the 23 joint angles
// in degrees (index_mcp_flexion_deg, ...), and the places of the fingertips on the stage in metres
// (thumb_tip_x_m, ...). The cell of a number that is not finite is empty.

#include <filesystem>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// Writes the table to `path`. Blocks. Errors: those of ChosenFrames::next(); failed (cannot be
/// written).
Result<Exported> export_motion_csv(ChosenFrames& frames, const std::filesystem::path& path);

} // namespace nendo::exporting
