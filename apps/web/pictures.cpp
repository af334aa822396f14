#include "web/pictures.hpp"

#include <charconv>

#include "render/texture_image.hpp"

namespace nendo::web {

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
  std::size_t number = 0;
  const char* const end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, number);
  if (error != std::errc{} || rest != end || text.size() > max_digits) return std::nullopt;
  return number;
}

} // namespace nendo::web
