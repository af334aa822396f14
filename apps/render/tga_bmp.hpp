#pragma once
// TGA and BMP files, for textures, by stb_image.

#include <string_view>

#include <nendo/base/result.hpp>

#include "render/image.hpp"

namespace nendo::render {

/// Returns whether a file's header is that of a BMP, or a TGA, which has no mark but a header that
/// no text and no other picture has.
bool is_bmp(std::string_view contents) noexcept;
bool is_tga(std::string_view contents) noexcept;

/// Returns the picture of a file that is_bmp() or is_tga(), of at most Size::most pixels along each
/// side. Errors: bad_input, with the end of a sentence that begins with the file's name.
Result<Image> decode_bmp(std::string_view contents);
Result<Image> decode_tga(std::string_view contents);

} // namespace nendo::render
