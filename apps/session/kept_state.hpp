#pragma once
// What the window keeps from one start to the next, in $XDG_STATE_HOME/nendo or
// ~/.local/state/nendo. Without such a folder nothing is kept. All calls block.

#include <string>
#include <vector>

namespace nendo::session {

/// Returns whether the hints of the first start are due: they were not closed yet, and that can be
/// kept.
bool are_hints_due();
/// Keeps that the hints were closed. A failure is no error: they come again.
void keep_hints_closed();

/// Returns the models and recordings that were opened or saved last and still exist, the latest
/// first.
std::vector<std::string> recent_files();
/// Puts a file first in that list. A failure is no error.
void keep_recent_file(const std::string& file);

} // namespace nendo::session
