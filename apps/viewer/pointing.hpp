#pragma once
// Relates pixels of the picture to places in the scene.

#include <optional>

#include "render/camera.hpp"
#include "render/image.hpp"

namespace nendo::viewer {

/// Returns the pixel at which a place is visible, from the picture's top left corner. Returns
/// nothing if the place is behind the camera.
std::optional<Eigen::Vector2d> pixel_of(const render::Camera& camera, const Eigen::Vector3d& place,
                                        render::Size size) noexcept;

/// Returns the displacement in metres that moves `place` by that many pixels in the picture while
/// its depth stays the same. `height` is the picture's height in pixels.
Eigen::Vector3d way_in_picture(const render::Camera& camera, const Eigen::Vector3d& place,
                               double dx, double dy, double height) noexcept;

/// Returns the displacement for steps of the wheel, 1 cm each. Positive steps go away from the
/// viewer.
Eigen::Vector3d way_by_wheel(const render::Camera& camera, double steps) noexcept;

} // namespace nendo::viewer
