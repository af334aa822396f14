#pragma once
// Three hints over the picture, for the first minutes.

namespace nendo::viewer {

/// Draws the hints at the top of the picture, beside what covers `covered_px` at its left. Returns
/// true when the user is done with them.
bool draw_hints(int covered_px);

} // namespace nendo::viewer
