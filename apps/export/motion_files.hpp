#pragma once
// Exports tables for plots, and the hands as BVH. README.md describes the columns, whose names end
// with their units. All cells are numbers; values that are not finite or not known are nan.

#include <array>
#include <filesystem>
#include <optional>

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

/// Indexed by flow::Placement::index_of(side). An empty element means that there is no such hand.
using Skeletons = std::array<std::optional<hand::HandSkeleton>, 2>;

/// Returns NAME-left.bvh or NAME-right.bvh for NAME.bvh.
std::filesystem::path path_of_hand(const std::filesystem::path& path, Side side);

/// `frames` must be at an even rate. One hand is written to `path`. Two hands are written to
/// NAME-left.bvh and NAME-right.bvh, of which neither appears before both are complete. Blocks.
/// Errors: those of ChosenFrames::next(); failed (a file cannot be written), bad_input (no hand, or
/// a pose that is not finite).
Result<Exported> export_hands_bvh(ChosenFrames& frames, const Skeletons& skeletons,
                                  const std::filesystem::path& path);

} // namespace nendo::exporting
