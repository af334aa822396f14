#pragma once
// Whole files in, with a limit; whole files out, so that nothing is ever half-written. Errors are
// one line that begins with the path. All of these block for as long as the disk does.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo {

/// Of a regular file only: a device or a pipe might never end. `kind` is what the file ought to be,
/// for the error: "mesh". Error: bad_input, also for more than `most_bytes`.
Result<std::string> read_file(const std::filesystem::path& path, std::uint64_t most_bytes,
                              std::string_view kind);

/// Writes a temporary file beside the file that `path` or its link leads to, syncs it and renames
/// it, so that this is either the old file or the whole new one; the temporary never stays.
/// Anything but a regular file is refused. Error: failed.
Result<void> replace_file(const std::filesystem::path& path, std::string_view contents);

/// Where a link leads; the path itself if there is nothing.
std::filesystem::path target_of(const std::filesystem::path& path);

} // namespace nendo
