#include "web/pictures.hpp"

#include "render/picture_kind.hpp"
#include "render/texture_image.hpp"

namespace nendo::web {

bool is_png(std::string_view contents) noexcept {
  return contents.starts_with("\x89PNG\r\n\x1A\n");
}

bool has_picture(const deform::Mesh& mesh, std::uint32_t texture) noexcept {
  const auto& textures = mesh.look.textures;
  if (mesh.corner_texcoords.empty() || texture >= textures.size()) return false;
  const auto& contents = textures[texture].contents;
  return contents && render::picture_kind_of(*contents) != render::PictureKind::none;
}

Pictures pictures_of(const deform::Mesh& mesh) {
  Pictures pictures;
  if (mesh.corner_texcoords.empty()) return pictures;
  for (const deform::Texture& texture : mesh.look.textures)
    pictures.push_back(render::as_png_or_jpeg(texture.contents));
  return pictures;
}

std::optional<std::size_t> picture_number(std::string_view text) noexcept {
  constexpr std::size_t max_digits = 6;
  if (text.empty() || text.size() > max_digits) return std::nullopt;
  std::size_t number = 0;
  for (const char digit : text) {
    if (digit < '0' || digit > '9') return std::nullopt;
    number = 10 * number + static_cast<std::size_t>(digit - '0');
  }
  return number;
}

} // namespace nendo::web
