#pragma once
// The colours of a model's triangles: those of its materials, and of vertices or corners. Without
// any, a model is of clay. And pictures on surfaces: decoded, and made smaller step by step for
// surfaces that are far away.

#include <array>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <Eigen/Core>

#include <nendo/base/result.hpp>
#include <nendo/deform/mesh.hpp>

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

/// Triangles that follow each other and have one base colour.
struct Coat {
  std::size_t first = 0;                            ///< triangle
  std::size_t count = 0;                            ///< number of triangles
  Eigen::Vector3f colour = Eigen::Vector3f::Ones(); ///< linear
  std::shared_ptr<const TextureImage> texture{};    ///< multiplies the colour; may be null
};

/// Never changes once it is made, so threads may share it.
class Paint {
public:
  /// Sets `corners` to the vertices of the triangles to be drawn, three for each, in the order of
  /// the coats: those without a material first, then material by material. Triangles of a material
  /// that is more than half transparent are left out, unless nothing would be left.
  Paint(const deform::Mesh& mesh, std::vector<std::uint32_t>& corners);

  const std::vector<Coat>& coats() const noexcept { return coats_; }
  /// Returns one linear colour for each vertex, which multiplies the coat's; empty if all are
  /// white.
  const std::vector<Eigen::Vector3f>& vertex_colours() const noexcept { return vertex_colours_; }
  /// Returns one linear colour for each triangle's corners, in place of the vertices'; empty if
  /// corners of one vertex do not differ.
  const std::vector<Eigen::Vector3f>& corner_colours() const noexcept { return corner_colours_; }
  /// Returns the texture coordinates of each triangle's corners; empty if no coat has a texture.
  const std::vector<Eigen::Vector2f>& texcoords() const noexcept { return texcoords_; }
  /// Returns the linear colour of a place in a triangle. `vertices` are its corners, and `shares`
  /// their shares, whose sum is 1. `samples` is how many samples of the picture fit along a side of
  /// a square as large as the triangle.
  Eigen::Vector3f colour_at(std::size_t triangle, const std::array<std::uint32_t, 3>& vertices,
                            const std::array<float, 3>& shares, float samples) const noexcept;

private:
  std::vector<Coat> coats_;
  std::vector<std::uint32_t> coat_of_; ///< the coat of each triangle
  std::vector<Eigen::Vector3f> vertex_colours_;
  std::vector<Eigen::Vector3f> corner_colours_;
  std::vector<Eigen::Vector2f> texcoords_;
};

/// Returns the greatest distance between a vertex at rest and in `shape` (3 by #vertices), model
/// units. Vertices that are not finite do not count.
double farthest_way(const deform::Mesh& rest, const deform::Points& shape);

/// Returns a paint of the same triangles as the model's own: grey where a vertex is where it is at
/// rest, then yellow and red, and dark red where it went by `farthest` (> 0) or more. Allocates.
std::shared_ptr<const Paint> paint_by_distance(const deform::Mesh& rest,
                                               const deform::Points& shape, double farthest);

} // namespace nendo::render
