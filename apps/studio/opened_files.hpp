#pragma once
// The files that the studio opens, by the endings of their names.

#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

namespace nendo::studio {

/// The endings of files that the studio opens.
std::vector<std::string> openable();
/// Returns whether a file of this name is a recording or a timeline.
bool opens_in_timeline(const std::string& file);
/// Error: bad_input, with all endings, if the studio opens no file of this name.
Result<void> check_openable(const std::string& name);
/// Writes a file that came from a browser into the current folder, beside what runs save there, and
/// returns its name: `name`, which has no path, with a number if something has that name already.
/// Errors: that of check_openable(), failed.
Result<std::string> store_sent(const std::string& name, std::string_view bytes);

} // namespace nendo::studio
