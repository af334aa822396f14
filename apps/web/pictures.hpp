#pragma once
// The model's textures, which clients get as the files that they are.

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <nendo/deform/mesh.hpp>

namespace nendo::web {

/// By their numbers in deform::Appearance::textures; null where there is no picture.
using Pictures = std::vector<std::shared_ptr<const std::string>>;

/// Returns the textures that are PNG or JPEG, by the first bytes. A file of another kind, which a
/// model may name as well, is not sent to anyone. None if the model has no texture coordinates.
Pictures pictures_of(const deform::Mesh& mesh);

bool is_png(std::string_view contents) noexcept;
bool is_jpeg(std::string_view contents) noexcept;

/// Parses the number of a picture: up to six decimal digits.
std::optional<std::size_t> picture_number(std::string_view text) noexcept;

} // namespace nendo::web
