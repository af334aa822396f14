#pragma once
// The window's own framebuffer. All calls: the thread with the OpenGL context.

#include "render/image.hpp"

namespace nendo::gl {

/// Returns whether the processor draws, because there is no graphics card.
bool draws_without_card();
void clear_screen();
/// Returns the pixels that were drawn last, from the bottom left corner. Blocks until all is drawn.
render::Image read_pixels(render::Size size);

} // namespace nendo::gl
