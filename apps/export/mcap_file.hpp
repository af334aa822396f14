#pragma once
// Exports hands as a recording for ROS 2 and Foxglove. apps/ros/README.md describes the topics.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "export/chosen_frames.hpp"
#include "timeline/timeline.hpp"

namespace nendo::exporting {

struct McapOptions {
  std::int64_t begun_utc_ns = 0; ///< when the take began, since 1970; its times count from there
  std::string library;           ///< names this program in the file
};

/// Writes joint states and transforms of each frame, and the commands from the first frame's time
/// to the last one's, to `path`, atomically. Blocks. Errors: those of ChosenFrames::next();
/// bad_input (no hand in a frame, or a pose or angle that is not finite), failed (the file cannot
/// be written).
Result<Exported> export_mcap(ChosenFrames& frames, std::span<const timeline::Event> commands,
                             const McapOptions& options, const std::filesystem::path& path);

} // namespace nendo::exporting
