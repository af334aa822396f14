#pragma once
// Pictures in widgets. Main thread, while a window is open.

#include <string_view>

#include "render/image.hpp"

namespace nendo::viewer {

/// A picture in the memory of the graphics card.
class Picture {
public:
  explicit Picture(const render::Image& image);
  ~Picture();
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  unsigned texture() const noexcept { return texture_; } ///< OpenGL's name
  float width_of_height() const noexcept { return ratio_; }

private:
  unsigned texture_ = 0;
  float ratio_ = 1.0F;
};

/// A button `width` pixels wide with a picture, and its name below. Null: an empty frame of
/// `ratio` times its height. Tests press it by its name.
bool picture_button(std::string_view name, const Picture* picture, float ratio, float width,
                    bool is_chosen = false);

} // namespace nendo::viewer
