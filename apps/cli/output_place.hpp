#pragma once
// Checks output files before long work, so that it does not end with an unwritable file.

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// Checks the path given with `option`. An empty path is valid: no file. The name must have one of
/// `endings` (".png"), in upper or lower case, if any are given. Errors: usage (wrong ending, or a
/// folder), failed (the folder is missing or not writable).
Result<void> check_place(std::string_view option, const std::string& path,
                         std::span<const std::string_view> endings);
Result<void> check_place(std::string_view option, const std::string& path,
                         std::initializer_list<std::string_view> endings = {});
/// Checks that the recording given with `option` does not exist yet; an empty path is valid. Error:
/// failed.
Result<void> check_new_recording(std::string_view option, const std::string& path);

/// Checks that the outputs, given with their options, are different files. Error: usage.
Result<void>
check_distinct(std::initializer_list<std::pair<std::string_view, std::string_view>> outputs);

/// Checks that `out`, given with `option`, does not overwrite the model, except with `force`: data
/// that readers drop (normals, materials, groups) would be lost. An empty path is valid. Error:
/// usage.
Result<void> check_spares(const std::string& model, std::string_view option, const std::string& out,
                          bool force);
/// The help of --force, in all commands.
inline constexpr const char* force_summary =
    "Overwrite the model itself, which loses its normals, materials and groups, or an existing "
    "puppet";

/// Returns the path of `to` relative to the folder of `from`, for use in that file. Error: usage
/// (the path cannot be quoted).
Result<std::string> name_beside(const std::string& to, const std::string& from);

/// Returns "a/shape-2.obj" for "a/shape.obj" and 2.
std::string numbered(const std::string& path, int number);
/// Increases `number` to the next one with an unused numbered() name, and returns that name. A
/// symbolic link uses its name, whether it leads somewhere or not.
std::string next_free_name(const std::string& path, int& number);
/// Does the same for a name that consists of `stem`, the number and `ending` (".timeline.toml").
std::string next_free_name(const std::string& stem, std::string_view ending, int& number);

} // namespace nendo::cli
