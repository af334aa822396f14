#pragma once
// Three hints over the picture, for the first minutes.

namespace nendo::viewer {

/// Draws the hints at the bottom of the picture, `below_px` above the window's, beside what covers
/// `covered_px` at its left. Returns true when the user is done with them.
bool draw_hints(int covered_px, float below_px);

} // namespace nendo::viewer
