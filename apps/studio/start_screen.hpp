#pragma once
// The start in the window: its choices, and the hands of the gloves, live. Main thread.

#include <string>

#include "studio/start_choices.hpp"
#include "viewer/scene_window.hpp"
#include "viewer/window_form.hpp"

namespace nendo::studio {

class StartScreen {
public:
  /// Begins to look for gloves, and to draw the models.
  StartScreen(viewer::SceneWindow& window, const StartOptions& options);

  /// Draws one picture, below the window's bar, and returns what was clicked.
  Wish show(viewer::SceneWindow& window);
  /// Returns whether the pictures of the models are drawn.
  bool is_complete() const { return choices_.is_complete(); }
  /// Returns the first glove that streams, or none.
  NamedGlove found_glove() const { return choices_.found_glove(); }

private:
  StartChoices choices_;
  viewer::WindowForm ways_, hands_;
};

} // namespace nendo::studio
