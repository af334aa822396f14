#include "gl/screen.hpp"

#include <string_view>
#include <vector>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

namespace nendo::gl {

bool draws_without_card() {
  const auto* const text = reinterpret_cast<const char*>(glGetString(GL_RENDERER));
  const std::string_view renderer = text != nullptr ? text : "";
  for (const char* name : {"llvmpipe", "softpipe", "Software Rasterizer"}) // Mesa's
    if (renderer.find(name) != std::string_view::npos) return true;
  return false;
}

void clear_screen() {
  glClear(GL_COLOR_BUFFER_BIT);
}

render::Image read_pixels(render::Size size) {
  std::vector<render::Pixel> rows(static_cast<std::size_t>(size.width) *
                                  static_cast<std::size_t>(size.height));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadBuffer(GL_BACK);
  glReadPixels(0, 0, size.width, size.height, GL_RGB, GL_UNSIGNED_BYTE, rows.data());
  render::Image image(size);
  for (int y = 0; y < size.height; ++y) // OpenGL begins at the bottom
    for (int x = 0; x < size.width; ++x)
      image.at(x, y) = rows[render::index_in_grid(x, size.height - 1 - y, size.width)];
  return image;
}

} // namespace nendo::gl
