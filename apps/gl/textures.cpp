#include "gl/textures.hpp"

#include <algorithm>
#include <map>

#include "gl/buffers.hpp"
#include "gl/shaders.hpp"

namespace nendo::gl {
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

void ModelTextures::set(const render::Paint& paint, const std::vector<std::uint32_t>& corners,
                        const std::vector<Eigen::Vector3f>& colours) {
  remove();
  std::map<const render::TextureImage*, GLuint> made;
  for (const render::Coat& coat : paint.coats()) {
    auto& name = made[coat.texture.get()];
    if (coat.texture && name == 0) name = texture_with(coat.texture->image());
    pictures_.push_back(name);
  }
  if (paint.texcoords().empty() && paint.corner_colours().empty()) return;
  std::vector<Eigen::Vector3f> tints = paint.corner_colours();
  if (tints.empty())
    for (const std::uint32_t corner : corners)
      tints.push_back(colours[corner]);
  glGenBuffers(3, buffers_.data());
  glGenTextures(3, buffer_textures_.data());
  const auto fill = [&](std::size_t which, GLenum format, const auto& values) {
    if (values.empty()) return;
    fill_buffer(GL_TEXTURE_BUFFER, buffers_[which], values, GL_STATIC_DRAW);
    glBindTexture(GL_TEXTURE_BUFFER, buffer_textures_[which]);
    glTexBuffer(GL_TEXTURE_BUFFER, format, buffers_[which]);
  };
  fill(0, GL_R32UI, corners);
  fill(1, GL_RG32F, paint.texcoords());
  fill(2, GL_R32F, tints); // OpenGL 3.3 has no buffers of three floats
}

void ModelTextures::bind() const {
  bind_texture(Unit::corner_places, GL_TEXTURE_BUFFER, buffer_textures_[0]);
  bind_texture(Unit::corner_texcoords, GL_TEXTURE_BUFFER, buffer_textures_[1]);
  bind_texture(Unit::corner_tints, GL_TEXTURE_BUFFER, buffer_textures_[2]);
}

bool ModelTextures::use(std::size_t coat) const {
  if (coat >= pictures_.size() || pictures_[coat] == 0) return false;
  bind_texture(Unit::picture, GL_TEXTURE_2D, pictures_[coat]);
  return true;
}

MatCapTextures::MatCapTextures() {
  glGenTextures(static_cast<GLsizei>(names_.size()), names_.data());
  for (std::size_t at = 0; at < names_.size(); ++at) {
    const render::Image image = matcap(static_cast<Material>(at + 1));
    glBindTexture(GL_TEXTURE_2D, names_[at]);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, image.size().width, image.size().height, 0, GL_RGB,
                 GL_UNSIGNED_BYTE, image.pixels().data());
    for (const GLenum filter : std::array<GLenum, 2>{GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : std::array<GLenum, 2>{GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  }
}

MatCapTextures::~MatCapTextures() {
  glDeleteTextures(static_cast<GLsizei>(names_.size()), names_.data());
}

void MatCapTextures::use(Material material) const {
  bind_texture(Unit::matcap, GL_TEXTURE_2D, names_[static_cast<std::size_t>(material) - 1]);
}

} // namespace nendo::gl
