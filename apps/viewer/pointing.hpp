#pragma once
// Relates pixels of the picture to places in the scene and on a model.

#include <array>
#include <cstdint>
#include <optional>

#include <nendo/deform/mesh.hpp>

#include "render/camera.hpp"
#include "render/image.hpp"

namespace nendo::viewer {

/// Returns the pixel at which a place is visible, from the picture's top left corner. Returns
/// nothing if the place is behind the camera.
std::optional<Eigen::Vector2d> pixel_of(const render::Camera& camera, const Eigen::Vector3d& place,
                                        render::Size size) noexcept;

/// Returns the displacement in metres that moves `place` by these pixels in the picture while
/// its depth stays the same. `height` is the picture's height in pixels.
Eigen::Vector3d way_in_picture(const render::Camera& camera, const Eigen::Vector3d& place,
                               double dx, double dy, double height) noexcept;

/// Returns the displacement for steps of the wheel, 1 cm each. Positive steps go away from the
/// viewer.
Eigen::Vector3d way_by_wheel(const render::Camera& camera, double steps) noexcept;

struct Ray {
  Eigen::Vector3d from;
  Eigen::Vector3d along; ///< unit length
};

/// Returns the line of sight through a pixel, counted from the picture's top left corner.
Ray ray_at(const render::Camera& camera, const Eigen::Vector2d& pixel, render::Size size) noexcept;

/// A place of a surface, with the normal of its triangle, which looks against the ray.
struct SurfaceHit {
  Eigen::Vector3d at;
  Eigen::Vector3d normal;
  std::array<std::uint32_t, 3> corners{};          ///< the triangle's vertices
  Eigen::Vector3d parts = Eigen::Vector3d::Zero(); ///< weights of the corners, whose sum `at` is
};

/// Returns the first place of the mesh's faces that the ray meets; nothing if it meets none. It
/// looks at all triangles. `rest` is where the vertices of a shaped model rest, which decides about
/// its triangles (triangles.hpp); null: as they are.
std::optional<SurfaceHit> first_hit(const deform::Mesh& mesh, const Ray& ray,
                                    const deform::Points* rest = nullptr);

} // namespace nendo::viewer
