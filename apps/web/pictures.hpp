#pragma once
// The model's textures, for clients.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::web {

/// By their numbers in deform::Appearance::textures; null where there is no picture.
using Pictures = std::vector<std::shared_ptr<const std::string>>;

/// Returns the textures as PNG or JPEG, which browsers show: a TGA or a BMP becomes a PNG, and
/// takes its time. A file of another kind, which a model may name as well, is not sent to anyone.
/// None if the model has no texture coordinates.
Pictures pictures_of(const deform::Mesh& mesh);
/// Returns whether a texture, by its first bytes alone, is among pictures_of(); a damaged one is
/// not.
bool has_picture(const deform::Mesh& mesh, std::uint32_t texture) noexcept;

/// Parses the number of a picture: up to six decimal digits.
std::optional<std::size_t> picture_number(std::string_view text) noexcept;

} // namespace nendo::web
