#pragma once
// A shadow map. All calls: the thread with the OpenGL context.

#include <Eigen/Geometry>

namespace nendo::gl {

/// A shadow map: the depths of all shadow casters, seen from the light.
class ShadowMap {
public:
  /// `side`: samples along a side.
  explicit ShadowMap(int side);
  ~ShadowMap();
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;

  /// Returns false if this OpenGL cannot render to such a map. Then there are no shadows.
  bool is_there() const noexcept { return is_there_; }
  /// Fits the map to a box of all casters, in metres, clears it, and binds it as framebuffer.
  /// `toward` is a unit vector to the light. Then draw the casters with map_of_world(), and call
  /// end(). Returns false, and changes nothing, if the box is empty or infinite.
  bool begin(const Eigen::AlignedBox3f& casting, const Eigen::Vector3f& toward);
  /// Binds the framebuffer that was bound before begin().
  void end() const;
  /// Returns the matrix from world coordinates to OpenGL's clip coordinates of the map.
  const Eigen::Matrix4f& map_of_world() const noexcept { return map_of_world_; }
  /// Returns the depth bias in metres: 4 mm, or more if the map's samples are coarse.
  float slack_m() const noexcept { return slack_m_; }
  /// Returns the depth texture, with comparison and linear filtering.
  unsigned texture() const noexcept { return texture_; }

private:
  int side_;
  unsigned texture_ = 0;
  unsigned frame_buffer_ = 0;
  int before_ = 0; ///< the framebuffer before begin()
  bool is_there_ = false;
  Eigen::Matrix4f map_of_world_ = Eigen::Matrix4f::Identity();
  float slack_m_ = 0.0F;
};

} // namespace nendo::gl
