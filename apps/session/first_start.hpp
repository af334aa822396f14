#pragma once
// Whether the user starts the window for the first time.

namespace nendo::session {

/// Returns whether the hints of the first start are due: they were not closed yet, and there is a
/// place to keep that they were ($XDG_STATE_HOME/nendo, or ~/.local/state/nendo). Blocks.
bool are_hints_due();
/// Keeps that the hints were closed. A failure is no error: they come again. Blocks.
void keep_hints_closed();

} // namespace nendo::session
