#pragma once
// How bright a place on a surface is, and in which colour.

#include "light_maps.hpp"

namespace nendo::viewer {

struct ShadedPlace {
  Eigen::Vector3f place;
  Eigen::Vector3f normal; ///< of any length
  float sky = 1.0F;       ///< what it sees of it
  bool shadowed = true;   ///< whether the key light may be kept from it
};

/// Linear, with the light that a clay gives back: diffuse, a soft highlight, a rim.
Eigen::Vector3f shade(const ShadedPlace& at, const Material& material, const Eigen::Vector3f& eye,
                      const Lighting::Maps& maps) noexcept;

/// 0 to 1, of a translucent surface that is looked at from `eye`.
float opacity_of(const ShadedPlace& at, const Material& material,
                 const Eigen::Vector3f& eye) noexcept;

/// How bright a ground is, of a background's brightness; 1 where it has faded out. footprint_m: of
/// a sample.
float ground_brightness(const ShadedPlace& at, const Material& material, float footprint_m,
                        const Lighting::Maps& maps) noexcept;

/// The background in the part `height` of a picture from its top.
Eigen::Vector3f background(float height) noexcept;

/// Linear, of any brightness, to what a screen is given.
Pixel encoded(const Eigen::Vector3f& colour) noexcept;

} // namespace nendo::viewer
