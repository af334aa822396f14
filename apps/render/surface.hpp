#pragma once
// Surfaces of triangles and their materials.

#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include "render/paint.hpp"

namespace nendo::render {

/// Colours are linear, 0 to 1: red, green, blue.
struct Material {
  Eigen::Vector3f colour{0.6F, 0.6F, 0.6F};
  float gloss = 0.15F;      ///< strength of the highlight
  float opacity = 1.0F;     ///< where the line of sight is perpendicular to the surface
  float rim_opacity = 1.0F; ///< where the line of sight is along the surface
  float grid_m = 0.0F;      ///< distance between a ground's lines; it has faded out at fade_m
  float fade_m = 0.0F;
  bool opaque_before_ground = false; ///< translucent only where the model or a solid is behind it
  bool shadowless = false;           ///< a mark on something else, which casts no shadow
  bool operator==(const Material&) const = default;
};

struct Surface {
  std::vector<Eigen::Vector3f> places;
  std::vector<Eigen::Vector3f> normals; ///< unit length, or zero where there is no face
  std::vector<std::uint32_t> corners;   ///< three for each triangle, counter-clockwise from outside
  Material material;
  std::shared_ptr<const Paint> paint{}; ///< colours in place of the material's

  bool is_empty() const noexcept { return corners.empty(); }
  bool operator==(const Surface&) const = default;
};

/// Computes the area-weighted normals of all places.
void compute_normals(std::span<const Eigen::Vector3f> places,
                     std::span<const std::uint32_t> corners, std::vector<Eigen::Vector3f>& normals);

/// Returns the triangles whose corners `takes` accepts, with only their places, in a material of
/// their own.
Surface part_of(const Surface& whole, const Material& material,
                const std::function<bool(std::span<const std::uint32_t, 3> corners)>& takes);

/// The following functions add to a surface. Radii must be positive.
/// Adds a ball at both ends and a cone between them, as rings of `sides` corners.
void add_capsule(Surface& surface, const Eigen::Vector3f& from, const Eigen::Vector3f& to,
                 float from_radius, float to_radius, int sides = 12);
void add_sphere(Surface& surface, const Eigen::Vector3f& middle, float radius, int sides = 24);
/// Adds an arrow from the first place to the second, or nothing if it would be shorter than its
/// width.
void add_arrow(Surface& surface, const Eigen::Vector3f& from, const Eigen::Vector3f& to,
               float width);

} // namespace nendo::render
