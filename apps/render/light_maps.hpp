#pragma once
// The lights of a picture, and how much of their light reaches its surfaces.

#include <vector>

#include "render/depth_map.hpp"
#include "render/picture.hpp"

namespace nendo::render {

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

} // namespace nendo::render
