#pragma once
// The font, the colours and the sizes of all windows. The colours are those of the browser's page
// (apps/web/page/page.css).

#include <imgui.h>

#include "viewer/window_look.hpp"

namespace nendo::viewer {

/// Gives ImGui's current context, before its first picture, a theme and sizes for a screen of this
/// scale: 1 for 96 dots per inch, 2 for twice as many. The font is Inter or DejaVu Sans, or ImGui's
/// own if neither is installed.
void use_theme(Theme theme, float scale);

/// The gap between panels and the window's edges, for em().
inline constexpr float gap_em = 0.7F;

/// Returns a length in multiples of the font's size, so that layouts follow the scale. Also between
/// pictures.
inline float em(float count) {
  return count * ImGui::GetIO().Fonts->Fonts[0]->FontSize;
}

/// Returns a larger font, for what is read from afar. It has the letters of Western languages.
ImFont* large_font();
/// Returns the scale of the screen that the theme has.
float scale();
/// Returns whether the theme is dark.
bool is_dark();
/// Returns the colour that marks what is chosen.
ImVec4 accent(float opacity = 1.0F);
/// Returns the colour of a warning.
ImVec4 warning();

} // namespace nendo::viewer
