#pragma once
// Shadow maps: how much of the lights and the sky reaches a surface.

#include <vector>

#include <nendo/viewer/picture.hpp>

namespace nendo::viewer {

/// How deep a scene is along a direction: the nearest to the light for each sample of a square.
class DepthMap {
public:
  /// `toward`: unit, to the light. Keeps what casts shadows: the model and what hands wear.
  DepthMap(const Scene& scene, const Eigen::Vector3f& toward, int side);

  /// Whether the nearest is farther from the light than `place`, less `slack_m`. Beyond the map,
  /// everything is lit.
  bool is_lit(const Eigen::Vector3f& place, float slack_m) const noexcept;
  /// The part of a neighbourhood of `reach` samples that is: a soft edge.
  float lit_part(const Eigen::Vector3f& place, float slack_m, int reach) const noexcept;
  float sample_m() const noexcept { return sample_m_; }

private:
  Eigen::Vector3f on_map(const Eigen::Vector3f& place) const noexcept;
  void cast(const Surface& surface);

  Eigen::Matrix3f rows_; ///< across, across, toward the light
  Eigen::Vector2f corner_;
  float sample_m_ = 1.0F;
  int side_;
  std::vector<float> nearest_; ///< along `toward`; the lowest number where nothing is
};

/// A direction that goes round with the view, about the upright axis. Unit.
Eigen::Vector3f turned(const Eigen::Vector3f& direction, double azimuth_deg);

struct Light {
  Eigen::Vector3f toward; ///< unit
  Eigen::Vector3f colour; ///< linear
};

struct Lighting::Maps {
  Light key, fill, rim;
  std::vector<DepthMap> key_shadow; ///< one
  std::vector<float> model_sky;     ///< of each vertex, 0 to about 1: what it sees of the sky
  std::vector<std::vector<float>> veil_sky;
  std::vector<std::vector<float>> ground_sky;
};

} // namespace nendo::viewer
