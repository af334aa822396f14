#pragma once
// A drawing of a form in the current window of ImGui, and the pointer in it. Main thread.

#include <map>
#include <memory>
#include <string_view>

#include "forms/drawing.hpp"
#include "gl/picture.hpp"

namespace nendo::viewer {

class WindowDrawing {
public:
  /// Draws it over the rest of the line. Returns what the user did in it since the last picture.
  forms::Pointer draw(std::string_view name, const forms::Drawing& drawing);

private:
  void follow_pictures(const forms::Drawing& drawing);

  /// On the graphics card, those of the last drawing.
  std::map<std::shared_ptr<const render::Image>, gl::Picture> pictures_;
};

} // namespace nendo::viewer
