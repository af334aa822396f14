#pragma once
// A pointer in the picture, and places that it means.

#include <optional>

#include <nendo/viewer/camera.hpp>
#include <nendo/viewer/image.hpp>

namespace nendo::viewer {

/// Where a place is seen, pixels from the picture's top left; nothing: behind the camera.
std::optional<Eigen::Vector2d> pixel_of(const Camera& camera, const Eigen::Vector3d& place,
                                        Size size) noexcept;

/// How far `place` goes if it stays at its depth while it is seen to go by so many pixels; metres.
Eigen::Vector3d way_in_picture(const Camera& camera, const Eigen::Vector3d& place, double dx,
                               double dy, double height) noexcept;

/// By steps of the wheel, 1 cm each: forward is away from the viewer.
Eigen::Vector3d way_by_wheel(const Camera& camera, double steps) noexcept;

} // namespace nendo::viewer
