#pragma once
// Writes the frames of an export one after another into a single file.

#include <filesystem>
#include <functional>

#include <nendo/base/file_replacement.hpp>

#include "export/chosen_frames.hpp"
#include "export/exported.hpp"

namespace nendo::exporting {

/// Writes the latest frame to the file. Before the first frame it also writes the file's header.
using PutFrame = std::function<Result<void>(FileReplacement& file)>;

/// Writes the file atomically and replaces an existing one. Blocks. Errors: those of
/// ChosenFrames::next(), `put` and FileReplacement.
Result<Exported> export_to_one_file(ChosenFrames& frames, const std::filesystem::path& path,
                                    const PutFrame& put);

} // namespace nendo::exporting
