#pragma once
// The line at the window's bottom: what the loop does, and how the gloves are. A message takes its
// place, so that nothing moves under the pointer.

#include <string>

#include "viewer/live_window.hpp"

namespace nendo::viewer {

/// Returns a volume in model units as text: "12.3 cm3".
std::string volume_text(const flow::Frame& frame, double volume);
/// Returns the bar's height in pixels.
float status_bar_height();
/// Draws the bar. message: shown instead; empty: none.
void draw_status_bar(const flow::Frame& frame, const Gauges& gauges, const std::string& message);

} // namespace nendo::viewer
