#pragma once
// Small files, whole: in with a limit, out so that nothing is ever half-written. Errors are one
// line that begins with the path.

#include <filesystem>
#include <string>
#include <string_view>

#include <nendo/base/result.hpp>

namespace nendo::hand {

inline constexpr std::size_t most_file_bytes = std::size_t{1} << 20;

/// Of a regular file of at most most_file_bytes: a device or a pipe might never end. Error:
/// bad_input.
Result<std::string> read_text_file(const std::filesystem::path& path);

/// Replaces the file that `path` or its link leads to by one step, when everything has reached the
/// disk. Error: failed; the old file is then as it was, and no temporary stays.
Result<void> replace_text_file(const std::filesystem::path& path, std::string_view contents);

/// Gives a file a second name, which must be free. 0, or the error number.
int add_name(const std::filesystem::path& path, const std::filesystem::path& second) noexcept;

/// Where a link leads; the path itself if there is nothing.
std::filesystem::path target_of(const std::filesystem::path& path);

} // namespace nendo::hand
