#pragma once
// Three hints over the picture, for the first minutes.

namespace nendo::viewer {

/// Draws the hints at the top of the picture, `above_px` below the window's top and beside what
/// covers `covered_px` at its left. Returns true when the user is done with them.
bool draw_hints(int covered_px, float above_px);

} // namespace nendo::viewer
