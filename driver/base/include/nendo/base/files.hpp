#pragma once
// Whole files in, with a limit; whole files out, so that nothing is ever half-written. Errors are
// one line that begins with the path. All of these block for as long as the disk does.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include <nendo/base/descriptor.hpp>
#include <nendo/base/result.hpp>

namespace nendo {

struct OpenFile {
  Descriptor file;
  std::uint64_t size = 0; ///< when it was opened
};

/// To read it piece by piece; a regular file only. `kind` as below. Error: bad_input.
Result<OpenFile> open_file(const std::filesystem::path& path, std::string_view kind);

/// Of a regular file only: a device or a pipe might never end. `kind` is what the file ought to be,
/// for the error: "mesh". Error: bad_input, also for more than `most_bytes`.
Result<std::string> read_file(const std::filesystem::path& path, std::uint64_t most_bytes,
                              std::string_view kind);

/// Writes a temporary file beside the file that `path` or its link leads to, syncs it and renames
/// it, so that this is either the old file or the whole new one, with the old one's mode. The
/// temporary goes if that fails; only a process that is killed leaves it (`.nendo.*.tmp`). Anything
/// but a regular file is refused. Error: failed.
Result<void> replace_file(const std::filesystem::path& path, std::string_view contents);

/// All of `bytes`, however many calls it takes; false, with errno, if the system refuses one. May
/// be called in a signal handler.
bool write_all(int fd, std::span<const std::byte> bytes) noexcept;
/// A new name is on the disk when its folder is. What a file system cannot sync is not worth
/// failing.
void sync_folder_of(const std::filesystem::path& file);

/// Where a link leads; the path itself if there is nothing.
std::filesystem::path target_of(const std::filesystem::path& path);

} // namespace nendo
