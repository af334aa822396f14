#include "gl/picture.hpp"

#include <algorithm>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

namespace nendo::gl {

Picture::Picture(const render::Image& image, Use use) {
  const bool on_model = use == Use::on_model;
  const render::Size size = image.size();
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  if (std::max(size.width, size.height) > most) return;
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, on_model ? GL_SRGB8 : GL_RGB8, size.width, size.height, 0, GL_RGB,
               GL_UNSIGNED_BYTE, image.pixels().data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  if (on_model) glGenerateMipmap(GL_TEXTURE_2D);
  const auto set = [](GLenum name, GLint value) { glTexParameteri(GL_TEXTURE_2D, name, value); };
  set(GL_TEXTURE_MIN_FILTER, on_model ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
  set(GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  set(GL_TEXTURE_WRAP_S, on_model ? GL_REPEAT : GL_CLAMP_TO_EDGE);
  set(GL_TEXTURE_WRAP_T, on_model ? GL_REPEAT : GL_CLAMP_TO_EDGE);
  glBindTexture(GL_TEXTURE_2D, 0);
}

Picture::~Picture() {
  glDeleteTextures(1, &texture_);
}

} // namespace nendo::gl
