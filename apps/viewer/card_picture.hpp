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

private:
  unsigned texture_ = 0;
};

/// A button `width` pixels wide with a picture, and its name below. Null: an empty frame of
/// `ratio` times its height. Tests press it by its name.
bool picture_card(std::string_view name, const CardPicture* picture, float ratio, float width,
                  bool is_chosen = false);

} // namespace nendo::viewer
