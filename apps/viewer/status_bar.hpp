#pragma once
// The line at the window's bottom: what the loop does, how the gloves are, and at the right a
// message, so that nothing moves under the pointer.

#include <string>

#include "viewer/live_window.hpp"

namespace nendo::viewer {

/// Returns the bar's height in pixels.
float status_bar_height();
/// Draws the bar. Figures without space beside the message are left out, the last ones first. An
/// error has the colour of warnings.
void draw_status_bar(const flow::Frame& frame, const Gauges& gauges, const std::string& message,
                     bool is_error);

} // namespace nendo::viewer
