#pragma once
// The files that the studio opens, by the endings of their names.

#include <string>
#include <vector>

namespace nendo::studio {

/// The endings of files that the studio opens.
std::vector<std::string> openable();
/// Returns whether a file of this name is a recording or a timeline.
bool opens_in_timeline(const std::string& file);

} // namespace nendo::studio
