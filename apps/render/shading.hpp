#pragma once
// Computes the colour and brightness of places on surfaces.

#include "render/light_maps.hpp"

namespace nendo::render {

struct ShadedPlace {
  Eigen::Vector3f place;
  Eigen::Vector3f normal; ///< not normalised
  float sky = 1.0F;       ///< how much of the sky the place sees
  bool shadowed = true;   ///< whether the key light can be blocked
};

/// Returns the linear colour of clay at a place: diffuse light, a soft highlight and a rim.
Eigen::Vector3f shade(const ShadedPlace& at, const Material& material, const Eigen::Vector3f& eye,
                      const Lighting::Maps& maps) noexcept;

/// Returns the opacity, 0 to 1, of a translucent surface seen from `eye`.
float opacity_of(const ShadedPlace& at, const Material& material,
                 const Eigen::Vector3f& eye) noexcept;

/// Returns the brightness of a ground as a factor of the background's brightness. It is 1 where the
/// ground has faded out. footprint_m: the size of a sample at that place.
float ground_brightness(const ShadedPlace& at, const Material& material, float footprint_m,
                        const Lighting::Maps& maps) noexcept;

/// Returns the linear colour of the background at `height`, from 0 at the top of the picture to 1
/// at the bottom.
Eigen::Vector3f background(float height) noexcept;

/// Encodes a linear colour of any brightness for the screen.
Pixel encoded(const Eigen::Vector3f& colour) noexcept;

} // namespace nendo::render
