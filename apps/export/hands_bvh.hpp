#pragma once
// The hands as BVH (nendo/hand/bvh.hpp), a file a hand: the format has one root.

#include <array>
#include <filesystem>
#include <optional>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// By flow::Placement::index_of(side); nothing: there is no such hand.
using Skeletons = std::array<std::optional<hand::HandSkeleton>, 2>;

/// `frames` are at a rate. One hand goes to `path`, two to NAME-left.bvh and NAME-right.bvh;
/// neither gets its name before both are written. Blocks. Errors: as ChosenFrames::next(); failed
/// (cannot be written), bad_input (no hand, a pose that is not finite).
Result<Exported> export_hands_bvh(ChosenFrames& frames, const Skeletons& skeletons,
                                  const std::filesystem::path& path);

} // namespace nendo::exporting
