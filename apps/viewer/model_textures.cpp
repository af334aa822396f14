#include "viewer/model_textures.hpp"

#include <algorithm>
#include <map>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include "viewer/gl_program.hpp"

namespace nendo::viewer {

namespace {

/// Returns the name of a texture with the picture; 0 if it is too large for the card.
GLuint texture_with(const render::Image& image) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  const render::Size size = image.size();
  if (std::max(size.width, size.height) > most) return 0;
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8, size.width, size.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
               image.pixels().data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
  return name;
}

} // namespace

ModelTextures::~ModelTextures() {
  remove();
}

void ModelTextures::remove() {
  std::sort(pictures_.begin(), pictures_.end()); // coats may share one
  pictures_.erase(std::unique(pictures_.begin(), pictures_.end()), pictures_.end());
  glDeleteTextures(static_cast<GLsizei>(pictures_.size()), pictures_.data());
  pictures_.clear();
  glDeleteTextures(3, buffer_textures_.data());
  glDeleteBuffers(3, buffers_.data());
  buffer_textures_ = {};
  buffers_ = {};
}

void ModelTextures::set(const render::Paint& paint, const std::vector<std::uint32_t>& corners) {
  remove();
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(units[3]));
  std::map<const render::TextureImage*, GLuint> made;
  for (const render::Coat& coat : paint.coats()) {
    auto& name = made[coat.texture.get()];
    if (coat.texture && name == 0) name = texture_with(coat.texture->image());
    pictures_.push_back(name);
  }
  if (paint.texcoords().empty() && paint.corner_colours().empty()) return;
  glGenBuffers(3, buffers_.data());
  glGenTextures(3, buffer_textures_.data());
  const auto fill = [&](std::size_t which, GLenum format, const auto& values) {
    if (values.empty()) return;
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(units[which]));
    glBindBuffer(GL_TEXTURE_BUFFER, buffers_[which]);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof values[0]),
                 values.data(), GL_STATIC_DRAW);
    glBindTexture(GL_TEXTURE_BUFFER, buffer_textures_[which]);
    glTexBuffer(GL_TEXTURE_BUFFER, format, buffers_[which]);
  };
  fill(0, GL_R32UI, corners);
  fill(1, GL_RG32F, paint.texcoords());
  fill(2, GL_R32F, paint.corner_colours()); // OpenGL 3.3 has no buffers of three floats
  glActiveTexture(GL_TEXTURE0);
}

void ModelTextures::bind(unsigned program) const {
  viewer::set(program, "corner_places", units[0]);
  viewer::set(program, "corner_texcoords", units[1]);
  viewer::set(program, "corner_tints", units[2]);
  viewer::set(program, "picture", units[3]);
  for (std::size_t which = 0; which < 3; ++which) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(units[which]));
    glBindTexture(GL_TEXTURE_BUFFER, buffer_textures_[which]);
  }
  glActiveTexture(GL_TEXTURE0);
}

bool ModelTextures::use(std::size_t coat) const {
  if (coat >= pictures_.size() || pictures_[coat] == 0) return false;
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(units[3]));
  glBindTexture(GL_TEXTURE_2D, pictures_[coat]);
  glActiveTexture(GL_TEXTURE0);
  return true;
}

} // namespace nendo::viewer
