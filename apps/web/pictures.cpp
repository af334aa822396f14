#include "web/pictures.hpp"

namespace nendo::web {

bool is_png(std::string_view contents) noexcept {
  return contents.starts_with("\x89PNG\r\n\x1A\n");
}

bool is_jpeg(std::string_view contents) noexcept {
  return contents.starts_with("\xFF\xD8\xFF");
}

Pictures pictures_of(const deform::Mesh& mesh) {
  Pictures pictures;
  if (mesh.corner_texcoords.empty()) return pictures;
  for (const deform::Texture& texture : mesh.look.textures) {
    const bool is_picture =
        texture.contents && (is_png(*texture.contents) || is_jpeg(*texture.contents));
    pictures.push_back(is_picture ? texture.contents : nullptr);
  }
  return pictures;
}

std::optional<std::size_t> picture_number(std::string_view text) noexcept {
  constexpr std::size_t most_digits = 6;
  if (text.empty() || text.size() > most_digits) return std::nullopt;
  std::size_t number = 0;
  for (const char digit : text) {
    if (digit < '0' || digit > '9') return std::nullopt;
    number = 10 * number + static_cast<std::size_t>(digit - '0');
  }
  return number;
}

} // namespace nendo::web
