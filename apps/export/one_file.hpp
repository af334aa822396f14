#pragma once
// An export whose frames stand one after another in a single file.

#include <filesystem>
#include <functional>

#include <nendo/base/file_replacement.hpp>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// Writes what stands in the file for the latest of `frames`; before the first, its head too.
using PutFrame = std::function<Result<void>(FileReplacement& file)>;

/// The file is there when it is whole, in place of what was there. Errors: as
/// ChosenFrames::next(), `put`, FileReplacement. Blocks.
Result<Exported> export_to_one_file(ChosenFrames& frames, const std::filesystem::path& path,
                                    const PutFrame& put);

} // namespace nendo::exporting
