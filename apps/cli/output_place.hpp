#pragma once
// Checks output files before the work, so that long work does not end in a file that cannot be
// written.

#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// Checks the path given with `option`. An empty path means that no file is wanted, and is right.
/// The name must end in one of `endings` (".png"), in any case, if any are given. Errors: usage
/// (wrong ending, or a folder), failed (the folder is missing or not writable).
Result<void> check_place(std::string_view option, const std::string& path,
                         std::span<const std::string_view> endings);
Result<void> check_place(std::string_view option, const std::string& path,
                         std::initializer_list<std::string_view> endings = {});
/// Checks that the recording given with `option` is a new file; an empty path is none. Error:
/// failed.
Result<void> check_new_recording(std::string_view option, const std::string& path);

/// Checks that all wanted outputs, given with their options, are different files. Error: usage.
Result<void>
check_distinct(std::initializer_list<std::pair<std::string_view, std::string_view>> outputs);

/// Checks that `out`, given with `option`, is not the model that was read, unless `force` is given:
/// what a reader of models drops (normals, materials, groups) would be lost. An empty path is no
/// file. Error: usage.
Result<void> check_spares(const std::string& model, std::string_view option, const std::string& out,
                          bool force);
/// The help of --force, in all commands.
inline constexpr const char* force_summary =
    "Overwrite the model itself, which loses its normals, materials and groups, or an existing "
    "puppet";

/// Returns how a text in the file `from` names the file `to`: by the way from its folder. Error:
/// usage (no text in quotes can name it).
Result<std::string> name_beside(const std::string& to, const std::string& from);

/// Returns "a/shape-2.obj" for "a/shape.obj" and 2.
std::string numbered(const std::string& path, int number);
/// Sets `number` to the next number whose name no file has, and returns that name.
std::string next_free_name(const std::string& path, int& number);

} // namespace nendo::cli
