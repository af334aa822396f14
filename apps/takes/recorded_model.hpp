#pragma once
// The model over which a loop was recorded, and whether what is made of both is as it was.

#include <string>

#include <nendo/recording/setup.hpp>

namespace nendo::takes {

/// Read from the file that `named` says, or from the recorded one where that is empty; says on
/// standard error if it is another model than was recorded. Errors: as deform::read_mesh();
/// bad_input, if the recorded file is no longer what it was.
Result<deform::Mesh> recorded_model(const recording::LoopSetup& loop,
                                    const std::string& named = {});
/// Of the recording in `file`. Error: bad_input also if no loop was recorded.
Result<deform::Mesh> recorded_model(const std::string& file, const recording::Setup& setup,
                                    const std::string& named = {});

/// Says on standard error that something is missing in the recording.
void note_missing(const std::string& file);

} // namespace nendo::takes
