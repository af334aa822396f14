#pragma once
// Exports the hands' motion as a table for plots, with one row for each frame. Columns, their units
// in their names: time_s (since the take began), tick, held (0 or 1), commits, undos, status (ok,
// merged, singular, too_dense, not_finite); then of each hand, left_ or right_ before the name:
// samples, silent (0 or 1), the 23 joint angles in degrees (index_mcp_flexion_deg, ...), and the
// fingertips' places on the stage in metres (thumb_tip_x_m, ...). A number that is not finite
// leaves its cell empty.

#include <filesystem>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// Blocks. Errors: those of ChosenFrames::next(); failed (cannot be written).
Result<Exported> export_motion_csv(ChosenFrames& frames, const std::filesystem::path& path);

} // namespace nendo::exporting
