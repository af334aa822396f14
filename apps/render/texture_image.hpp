#pragma once
// Pictures on surfaces: decoded, and made smaller step by step for surfaces that are far away.

#include <optional>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "render/image.hpp"

namespace nendo::render {

/// Returns the picture of a PNG or JPEG file, of at most Size::most pixels along each side, or
/// nothing if it is damaged or something else. What is transparent becomes black.
std::optional<Image> decode_picture(const std::string& contents);

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
