#pragma once
// The colours of a model's triangles: those of its materials, and of vertices or corners. Without
// any, a model is of clay.

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include <Eigen/Core>

#include <nendo/deform/mesh.hpp>

#include "render/texture_image.hpp"

namespace nendo::render {

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
