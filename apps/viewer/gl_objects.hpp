#pragma once
// OpenGL's programs, a model's textures, and frame buffers. All calls belong to the thread that has
// the OpenGL context.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>

#include "render/image.hpp"
#include "render/paint.hpp"

namespace nendo::viewer {

/// The fragment shader of a program: for depths and silhouettes, for grounds, or for surfaces.
enum class Fragments : std::size_t { white, ground, surface };

/// Makes a program and returns its name. Error: failed (this OpenGL refuses the shaders; the
/// message has its reason).
Result<unsigned> make_program(Fragments kind);

/// Sets a uniform of the program, which must be in use.
void set(unsigned program, const char* name, const Eigen::Matrix4f& value);
void set(unsigned program, const char* name, const Eigen::Vector3f& value);
void set(unsigned program, const char* name, float value);
void set(unsigned program, const char* name, int value);

/// The textures of a model, and the texture coordinates and colours of its triangles' corners.
class ModelTextures {
public:
  /// The units of the textures that the shaders read: corners, their texture coordinates, their
  /// colours, picture.
  static constexpr std::array<int, 4> units{4, 5, 6, 7};

  ModelTextures() = default;
  ~ModelTextures();
  ModelTextures(const ModelTextures&) = delete;
  ModelTextures& operator=(const ModelTextures&) = delete;

  /// Sets the paint of another model. `corners` are the vertices' places in the blocks, three for
  /// each triangle. A picture that is too large for the card is left out.
  void set(const render::Paint& paint, const std::vector<std::uint32_t>& corners);
  /// Prepares the program, which must be in use, for the next calls of use().
  void bind(unsigned program) const;
  /// Makes the coat's picture the one that is drawn. Returns false if it has none.
  bool use(std::size_t coat) const;

private:
  void remove();

  std::array<unsigned, 3> buffers_{};
  std::array<unsigned, 3> buffer_textures_{}; ///< 0 where corners have nothing of their own
  std::vector<unsigned> pictures_;            ///< one for each coat; 0: none
};

/// The shadow that a light casts, as the depth of all that casts, seen from the light.
class ShadowMap {
public:
  ShadowMap();
  ~ShadowMap();
  ShadowMap(const ShadowMap&) = delete;
  ShadowMap& operator=(const ShadowMap&) = delete;

  /// Returns false if this OpenGL cannot draw into such a map. Then there are no shadows.
  bool is_there() const noexcept { return is_there_; }
  /// Fits the map to a box with all that casts a shadow, in metres, and makes the empty map the
  /// frame buffer. `toward` is a unit vector to the light. Draw what casts, with map_of_world(),
  /// and call end(). Returns false, and changes nothing, if the box is empty or infinite.
  bool begin(const Eigen::AlignedBox3f& casting, const Eigen::Vector3f& toward);
  /// Makes what was the frame buffer before begin() the frame buffer again.
  void end() const;
  /// Returns the matrix from world coordinates to OpenGL's clip coordinates of the map.
  const Eigen::Matrix4f& map_of_world() const noexcept { return map_of_world_; }
  /// Returns how far from a surface something must be to be certainly not on it, in metres. It is
  /// 4 mm, or more if the map's samples are coarse.
  float slack_m() const noexcept { return slack_m_; }
  /// Returns the texture with the depths, which compares by itself and smooths between samples.
  unsigned texture() const noexcept { return texture_; }

  static constexpr int side = 2048; ///< samples

private:
  unsigned texture_ = 0;
  unsigned frame_buffer_ = 0;
  int before_ = 0; ///< the frame buffer before begin()
  bool is_there_ = false;
  Eigen::Matrix4f map_of_world_ = Eigen::Matrix4f::Identity();
  float slack_m_ = 0.0F;
};

/// A frame buffer that may have several samples per pixel, so that edges are smooth also where the
/// window's own buffer has one.
class SmoothTarget {
public:
  SmoothTarget() = default;
  ~SmoothTarget();
  SmoothTarget(const SmoothTarget&) = delete;
  SmoothTarget& operator=(const SmoothTarget&) = delete;

  /// Makes this the frame buffer, of that size; if `smooth`, with several samples for each pixel as
  /// far as this OpenGL has them. If it has no such buffer, the window's own remains the frame
  /// buffer.
  void begin(render::Size size, bool smooth);
  /// Makes the window's buffer the frame buffer again, and copies the picture into it, `below`
  /// pixels above the bottom.
  void end(int below) const;
  /// Returns whether end() may be called again: the picture is still there.
  bool keeps() const noexcept { return frame_buffer_ != 0; }

private:
  void make(render::Size size, bool smooth);
  void drop() noexcept;

  static constexpr int max_samples = 4;
  unsigned frame_buffer_ = 0;
  unsigned colours_ = 0, depths_ = 0;
  render::Size size_;
  bool smooth_ = false;
};

} // namespace nendo::viewer
