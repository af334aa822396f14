#pragma once
// JPEG files, for textures.

#include <optional>
#include <string_view>

#include "render/image.hpp"

namespace nendo::render {

/// Returns the picture, of at most Size::most pixels along each side; nothing if the file is
/// damaged or something else. Of a file that is cut off, the rest is grey.
std::optional<Image> decode_jpeg(std::string_view contents);

} // namespace nendo::render
