#pragma once
// How a window looks.

#include <cstdint>
#include <optional>

#include "render/image.hpp"

namespace nendo::viewer {

enum class Theme : std::uint8_t { light, dark };

struct WindowLook {
  render::Size size{1280, 800}; ///< on a screen of scale 1
  Theme theme = Theme::light;
  std::optional<float> scale{}; ///< the scale of fonts and widgets; nothing: the monitor's
};

} // namespace nendo::viewer
