#pragma once
// Where files go. An hour of work must not end in one that cannot be written, so that is asked
// before, and what is already there stays.

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

#include <nendo/base/result.hpp>

namespace nendo::cli {

/// Of the path given with `option`; an empty one is not wanted, and fine. The name must end in one
/// of `endings` (".png"), if any are given. Errors: usage (its ending, a folder), failed (not there
/// or not yours).
Result<void> check_place(std::string_view option, const std::string& path,
                         std::initializer_list<std::string_view> endings = {});

/// Whether all outputs that are wanted, by their options, are different files. Error: usage.
Result<void>
check_distinct(std::initializer_list<std::pair<std::string_view, std::string_view>> outputs);

/// "a/shape-2.obj" of "a/shape.obj" and 2.
std::string numbered(const std::string& path, int number);
/// The next number, after `number`, whose name no file has; that name.
std::string next_free_name(const std::string& path, int& number);

} // namespace nendo::cli
