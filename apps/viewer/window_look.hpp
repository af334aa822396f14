#pragma once
// How a window looks.

#include <cstdint>
#include <optional>
#include <string_view>

#include "render/image.hpp"

namespace nendo::viewer {

enum class Theme : std::uint8_t { light, dark };
/// Returns the theme of that name; light for another name.
constexpr Theme theme_named(std::string_view name) noexcept {
  return name == "dark" ? Theme::dark : Theme::light;
}

struct WindowLook {
  render::Size size{1280, 800}; ///< on a screen of scale 1
  Theme theme = Theme::light;
  std::optional<float> scale{}; ///< the scale of fonts and widgets; nothing: the monitor's
};

} // namespace nendo::viewer
