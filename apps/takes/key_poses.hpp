#pragma once
// The most expressive moments of a take.

#include <cstddef>
#include <vector>

#include "takes/frame_source.hpp"

namespace nendo::takes {

/// Returns the times of the first frame, and of those that differ the most from all that were
/// chosen before, and that the hands hold for 0.2 s, if there are such: in the values of a puppet's
/// functions, or else in the hands' joint angles (farthest-point sampling, Gonzalez 1985). At most
/// `count` times, in their order; fewer if no other frame differs. Reads `frames` to the end.
/// Blocks and allocates.
std::vector<double> key_poses(FrameSource& frames, std::size_t count);

} // namespace nendo::takes
