#pragma once
// Exports the hands as BVH (nendo/hand/bvh_file.hpp), one file for each hand, because the format has a
// single root.

#include <array>
#include <filesystem>
#include <optional>

#include "export/chosen_frames.hpp"

namespace nendo::exporting {

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
