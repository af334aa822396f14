#pragma once
// Shadow maps: how much of the lights and the sky reaches a surface.

#include <vector>

#include "render/picture.hpp"

namespace nendo::render {

/// The depth of a scene along a direction. For each sample of a square, it keeps the place that is
/// nearest to the light.
class DepthMap {
public:
  /// `toward` is a unit vector to the light, and `side` is the number of samples along each side.
  /// The map has all that casts shadows: the model and the hands' skins.
  DepthMap(const Scene& scene, const Eigen::Vector3f& toward, int side);

  /// Returns true if nothing is nearer to the light than `place` by more than slack_m. Outside of
  /// the map, everything is lit.
  bool is_lit(const Eigen::Vector3f& place, float slack_m) const noexcept;
  /// Returns the lit part, 0 to 1, of the samples within `reach` samples of `place`. It gives a
  /// shadow a soft edge.
  float lit_part(const Eigen::Vector3f& place, float slack_m, int reach) const noexcept;
  float sample_m() const noexcept { return sample_m_; }

private:
  Eigen::Vector3f on_map(const Eigen::Vector3f& place) const noexcept;
  void cast(const Surface& surface);

  Eigen::Matrix3f rows_; ///< across, across, toward the light
  Eigen::Vector2f corner_;
  float sample_m_ = 1.0F;
  int side_;
  std::vector<float> nearest_; ///< along `toward`; the lowest float where there is nothing
};

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

struct Lighting::Maps {
  Light key, fill, rim;
  std::vector<DepthMap> key_shadow; ///< has one element
  std::vector<float> model_sky;     ///< how much of the sky each vertex sees, 0 to about 1
  std::vector<std::vector<float>> veil_sky;
  std::vector<std::vector<float>> ground_sky;
};

} // namespace nendo::render
