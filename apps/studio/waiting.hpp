#pragma once
// A picture without a model, for the time in which something is read or opened. Main thread.

#include <string>

#include "viewer/scene_window.hpp"

namespace nendo::studio {

/// Draws one picture with a text in its middle and, if `button` is not empty, a button below.
/// Returns whether that was pressed.
bool show_waiting(viewer::SceneWindow& window, const std::string& text,
                  const std::string& button = {});

} // namespace nendo::studio
