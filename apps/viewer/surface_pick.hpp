#pragma once
// What of a model is under the pointer.

#include <array>
#include <cstdint>
#include <optional>

#include <nendo/deform/mesh.hpp>

#include "render/camera.hpp"
#include "render/image.hpp"

namespace nendo::viewer {

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
  std::array<std::uint32_t, 3> corners{};          ///< of that triangle
  Eigen::Vector3d parts = Eigen::Vector3d::Zero(); ///< of each corner, of which `at` is the sum
};

/// Returns the first place of the mesh's faces that the ray meets; nothing if it meets none. It
/// looks at all triangles. `rest` is where the vertices of a shaped model rest, which decides about
/// its triangles (triangles.hpp); null: as they are.
std::optional<SurfaceHit> first_hit(const deform::Mesh& mesh, const Ray& ray,
                                    const deform::Points* rest = nullptr);

} // namespace nendo::viewer
