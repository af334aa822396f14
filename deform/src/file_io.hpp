#pragma once
// Whole files in, whole files out.

#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::deform {

inline constexpr std::uint64_t most_file_bytes = std::uint64_t{4} << 30;

/// Of a regular file only: a device or a pipe might never end. Error: bad_input.
Result<std::string> read_file(const std::filesystem::path& path);

/// Writes a temporary file beside `path`, syncs it and renames it, so that `path` is either the old
/// file or the whole new one; the temporary never stays. A symbolic link is followed, anything but
/// a regular file refused. Error: failed.
Result<void> replace_file(const std::filesystem::path& path, std::string_view contents);

} // namespace nendo::deform
