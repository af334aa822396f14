#pragma once
// The files that the studio opens, by the endings of their names.

#include <string>
#include <string_view>
#include <vector>

#include <nendo/base/result.hpp>

#include "studio/wish.hpp"

namespace nendo::studio {

/// The endings of files that the studio opens.
std::vector<std::string> openable();
/// Returns whether a file of this name is a recording or a timeline.
bool opens_in_timeline(const std::string& file);
/// The name of the button that opens a file in the timeline, when none is open.
inline constexpr const char* open_button = "Open a recording or a timeline...";
/// Error: bad_input, with all endings, if the studio opens no file of this name.
Result<void> check_openable(const std::string& name);
/// Returns also an error if there is no such file. Who uses the page from elsewhere learns nothing
/// of files that the studio does not open.
Result<void> check_there(const std::string& file);
/// Writes a file that came from a browser into the current folder, beside what runs save there, and
/// returns its name: `name`, which has no path, with a number if something has that name already,
/// or if it is that of `reserved`, where something will be saved; empty: nothing. Errors: that of
/// check_openable(), failed.
Result<std::string> store_sent(const std::string& name, std::string_view bytes,
                               const std::string& reserved = {});
/// Removes the file of a wish that is not followed, if a browser sent it.
void remove_sent(const Wish& wish);

} // namespace nendo::studio
