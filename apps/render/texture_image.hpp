#pragma once
// Pictures on surfaces: decoded, and made smaller step by step for surfaces that are far away.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <nendo/base/result.hpp>

#include "render/image.hpp"

namespace nendo::render {

/// The kind of a texture's file.
enum class PictureKind { none, png, jpeg, bmp, tga };

/// Returns the kind by the first bytes; none if the file is nothing that is decoded here.
PictureKind picture_kind_of(std::string_view contents) noexcept;

/// Returns the picture of a PNG, JPEG, TGA or BMP file, of at most Size::most pixels along each
/// side. What is transparent becomes black in a PNG, and is opaque elsewhere. Error: bad_input,
/// with the end of a sentence that begins with the file's name, such as "is a WebP picture, which
/// is not read; save it as PNG or JPEG".
Result<Image> decode_picture(std::string_view contents);

/// Returns what is wrong with a texture's file, in the same words, or an empty text. Decodes it.
std::string fault_of_picture(std::string_view contents);

/// Returns the file if it is a PNG or a JPEG, and if it is a TGA or a BMP, a PNG of the same
/// picture. Nothing if it is something else, or if a TGA or BMP is damaged.
std::shared_ptr<const std::string>
as_png_or_jpeg(const std::shared_ptr<const std::string>& contents);

/// Never changes once it is made, so threads may share it.
class TextureImage {
public:
  explicit TextureImage(Image image);

  const Image& image() const noexcept { return levels_.front(); }
  /// Returns the linear colour at a texture coordinate, mixed of the four pixels about it. The
  /// picture repeats itself, and v points up. `span_pixels` is how many of the picture's pixels one
  /// sample covers along a side; a smaller picture is used if it is more than one.
  Eigen::Vector3f colour_at(const Eigen::Vector2f& uv, float span_pixels) const noexcept;

private:
  std::vector<Image> levels_; ///< each has half the sides of the one before
};

} // namespace nendo::render
