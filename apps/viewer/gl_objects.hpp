#pragma once
// Shader programs, a model's textures, and framebuffers. All calls: the thread with the OpenGL
// context.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>

#include "render/image.hpp"
#include "render/paint.hpp"
#include "viewer/matcap.hpp"

namespace nendo::viewer {

/// The kind of a program: of one colour, for depths, silhouettes and outlines; for ground planes;
/// for surfaces; for surfaces with one material; for a model with a MatCap; or for one whose
/// triangles are of a few pixels, with colours computed at its vertices.
enum class Fragments : std::size_t { flat, ground, surface, plain, matcap, merged };
inline constexpr std::size_t fragments_count = 6;

/// Makes a program and returns its name. Error: failed (the shaders do not compile; the message has
/// the log).
Result<unsigned> make_program(Fragments kind);

/// Sets a uniform of the program, which must be in use.
void set(unsigned program, const char* name, const Eigen::Matrix4f& value);
void set(unsigned program, const char* name, const Eigen::Matrix3f& value);
void set(unsigned program, const char* name, std::span<const Eigen::Vector4f> values);
void set(unsigned program, const char* name, const Eigen::Vector2f& value);
void set(unsigned program, const char* name, const Eigen::Vector3f& value);
void set(unsigned program, const char* name, float value);
void set(unsigned program, const char* name, int value);

/// The textures of a model, and the texture coordinates and colours of its triangles' corners.
class ModelTextures {
public:
  /// The texture units of the shaders: corners, their texture coordinates, their colours, picture.
  static constexpr std::array<int, 4> units{4, 5, 6, 7};

  ModelTextures() = default;
  ~ModelTextures();
  ModelTextures(const ModelTextures&) = delete;
  ModelTextures& operator=(const ModelTextures&) = delete;

  /// Sets the paint of a model. `corners` are indices of vertices in the blocks, three per
  /// triangle. Omits pictures that are too large for the GPU.
  void set(const render::Paint& paint, const std::vector<std::uint32_t>& corners);
  /// Prepares the program, which must be in use, for the next calls of use().
  void bind(unsigned program) const;
  /// Selects the coat's picture for drawing. Returns false if it has none.
  bool use(std::size_t coat) const;

private:
  void remove();

  std::array<unsigned, 3> buffers_{};
  std::array<unsigned, 3> buffer_textures_{}; ///< 0: no such data per corner
  std::vector<unsigned> pictures_;            ///< one per coat; 0: none
};

/// The pictures of all MatCaps.
class MatCapTextures {
public:
  static constexpr int unit = 8; ///< the shader's texture unit, after those of ModelTextures

  MatCapTextures();
  ~MatCapTextures();
  MatCapTextures(const MatCapTextures&) = delete;
  MatCapTextures& operator=(const MatCapTextures&) = delete;
  /// Selects the material's picture, which must be a MatCap, for drawing.
  void use(Material material) const;

private:
  std::array<unsigned, material_names.size() - 1> names_{};
};

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

/// A framebuffer with optional multisampling, for smooth edges if the window's own buffer has one
/// sample per pixel.
class SmoothTarget {
public:
  SmoothTarget() = default;
  ~SmoothTarget();
  SmoothTarget(const SmoothTarget&) = delete;
  SmoothTarget& operator=(const SmoothTarget&) = delete;

  /// Binds this framebuffer, of that size and, with `smooth`, multisampled as far as this OpenGL
  /// supports it. Without such a buffer, the window's own stays bound.
  void begin(render::Size size, bool smooth);
  /// Binds the window's buffer, and copies the picture into it, in that size, `below` pixels above
  /// the bottom.
  void end(render::Size shown, int below) const;
  /// Returns whether the picture still exists, so that end() may be called again.
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
