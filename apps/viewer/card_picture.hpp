#pragma once
// Cards: buttons with pictures. Main thread, while a window is open.

#include <string_view>

#include "render/image.hpp"

namespace nendo::viewer {

/// A picture in the memory of the graphics card.
class CardPicture {
public:
  explicit CardPicture(const render::Image& image);
  ~CardPicture();
  CardPicture(const CardPicture&) = delete;
  CardPicture& operator=(const CardPicture&) = delete;

  unsigned texture() const noexcept { return texture_; } ///< OpenGL's name
  float width_of_height() const noexcept { return ratio_; }

private:
  unsigned texture_ = 0;
  float ratio_ = 1.0F;
};

/// A button `width` pixels wide with a picture, and its name below. Null: an empty frame of
/// `ratio` times its height. Tests press it by its name.
bool picture_card(std::string_view name, const CardPicture* picture, float ratio, float width,
                  bool is_chosen = false);

} // namespace nendo::viewer
