#pragma once
// What kind of picture a texture's file is.

#include <string_view>

namespace nendo::render {

enum class PictureKind { none, png, jpeg, bmp, tga };

/// Returns the kind by the first bytes; none if the file is nothing that is decoded here.
PictureKind picture_kind_of(std::string_view contents) noexcept;

/// Returns the name of the format of a file that is not decoded here, with its article, such as "a
/// WebP picture", or an empty text if it is not known either.
std::string_view foreign_format_of(std::string_view contents) noexcept;

} // namespace nendo::render
