#pragma once
// A picture in the memory of the graphics card. All calls: the thread with the OpenGL context.

#include <cstdint>

#include "render/image.hpp"

namespace nendo::gl {

class Picture {
public:
  /// flat: with the image's own colours, for widgets and MatCaps. on_model: decoded from sRGB,
  /// repeated, and with smaller copies, which are sharp from afar.
  enum class Use : std::uint8_t { flat, on_model };

  explicit Picture(const render::Image& image, Use use = Use::flat);
  ~Picture();
  Picture(const Picture&) = delete;
  Picture& operator=(const Picture&) = delete;

  /// Returns OpenGL's name; 0 if the picture is too large for the card.
  unsigned texture() const noexcept { return texture_; }

private:
  unsigned texture_ = 0;
};

} // namespace nendo::gl
