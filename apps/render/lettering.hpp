#pragma once
// Words in pictures. Their letters are strokes on a grid, because pictures must have the same bytes
// on every machine: a font package or a rasteriser library of another version draws other pixels,
// and Dear ImGui's embedded font is there only in builds with a window.

#include <string_view>

#include "render/image.hpp"

namespace nendo::render {

/// Writes words in a plain upright stroke font. `height` is the height of capitals above the
/// baseline in pixels, and (x, y) is where the baseline begins. A character that the font does not
/// have appears as a box.
void write_words(Image& image, double x, double y, double height, std::string_view words,
                 Pixel colour);
/// Returns the width of the words in pixels.
double width_of_words(std::string_view words, double height) noexcept;

} // namespace nendo::render
