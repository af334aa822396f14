#include "gl/textures.hpp"

#include <map>

#include "gl/buffers.hpp"
#include "gl/shaders.hpp"

namespace nendo::gl {

ModelTextures::~ModelTextures() {
  remove();
}

void ModelTextures::remove() {
  pictures_.clear();
  glDeleteTextures(3, buffer_textures_.data());
  glDeleteBuffers(3, buffers_.data());
  buffer_textures_ = {};
  buffers_ = {};
}

void ModelTextures::set(const render::Paint& paint, const std::vector<std::uint32_t>& corners,
                        const std::vector<Eigen::Vector3f>& colours) {
  remove();
  std::map<const render::TextureImage*, std::shared_ptr<const Picture>> made;
  for (const render::Coat& coat : paint.coats()) {
    auto& picture = made[coat.texture.get()];
    if (coat.texture && !picture)
      picture = std::make_shared<Picture>(coat.texture->image(), Picture::Use::on_model);
    pictures_.push_back(picture);
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
  if (coat >= pictures_.size() || !pictures_[coat] || pictures_[coat]->texture() == 0) return false;
  bind_texture(Unit::picture, GL_TEXTURE_2D, pictures_[coat]->texture());
  return true;
}

} // namespace nendo::gl
