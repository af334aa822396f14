#pragma once
// JPEG files, for textures.

#include <string_view>

#include <nendo/base/result.hpp>

#include "render/image.hpp"

namespace nendo::render {

struct DecodedJpeg {
  Image image;
  bool is_whole = true; ///< false: some of it is damaged, or, where the file is cut off, grey
};

/// Returns the size that the file's header says. Errors as of decode_jpeg().
Result<Size> size_of_jpeg(std::string_view contents);

/// Returns the picture, of at most Size::most pixels along each side. Errors: bad_input, with the
/// end of a sentence that begins with the file's name.
Result<DecodedJpeg> decode_jpeg(std::string_view contents);

} // namespace nendo::render
