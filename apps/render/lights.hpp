#pragma once
// The lights of a picture, how much of their light and of the sky's reaches its surfaces, and the
// colours that places on surfaces get by it.

#include <span>
#include <vector>

#include "render/depth_map.hpp"
#include "render/picture.hpp"
#include "render/surface.hpp"

namespace nendo::render {

/// Returns, for each place of each surface, how much of the sky and of the light that the ground
/// gives back it sees, 0 to about 1. The sky's maps have `side` samples along a side. Uses
/// `threads` threads; their number does not change a bit.
std::vector<std::vector<float>> sky_parts(std::span<const Caster> casters,
                                          const std::vector<const Surface*>& surfaces,
                                          unsigned threads, int side = 320);

/// Returns whether the sky's light sees a coarser stand-in of the surface.
bool is_dense(const Surface& surface) noexcept;

/// Returns the places and the triangles of a coarser surface, for the sky's shadows: the places in
/// each cube of a grid become their mean, and triangles with two corners in one cube are left out.
/// A closed surface stays closed. There are `cubes` along the longest side of the surface's box.
/// Places that are no numbers, or are far away, are left out with their triangles.
Surface coarse_surface(const Surface& surface, int cubes = 160);

/// Does the same with places of the surface: of those in each cube, the one that is nearest to
/// their mean stands for all. Returns the corners of the triangles, which are indices of `places`.
std::vector<std::uint32_t> coarse_corners(std::span<const Eigen::Vector3f> places,
                                          std::span<const std::uint32_t> corners, int cubes);

/// The directions to the lights, seen from the front. They turn with the view.
inline const Eigen::Vector3f key_direction{-0.55F, 0.75F, 0.55F};
inline const Eigen::Vector3f fill_direction{0.85F, 0.25F, 0.50F};
inline const Eigen::Vector3f rim_direction{0.45F, 0.45F, -0.80F};

/// Returns the direction turned with the view around the vertical axis, as a unit vector.
Eigen::Vector3f turned(const Eigen::Vector3f& direction, double azimuth_deg);

struct Light {
  Eigen::Vector3f toward; ///< unit
  Eigen::Vector3f colour; ///< linear
};

/// How much of the sky each vertex sees, 0 to about 1.
struct Skies {
  std::vector<float> model;
  std::vector<std::vector<float>> veils; ///< empty for those that cast no shadow
  std::vector<std::vector<float>> grounds;
};

struct Lighting::Maps {
  Light key, fill, rim;
  DepthMap key_shadow;
  Skies skies;
};

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
