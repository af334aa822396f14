#pragma once
// Shader programs. All calls: the thread with the OpenGL context.

#include <cstddef>
#include <span>

#include <Eigen/Core>

#include <nendo/base/result.hpp>

namespace nendo::gl {

/// The kind of a program: of one colour, for depths, silhouettes and outlines; for ground planes;
/// for surfaces; for surfaces with one material; for a model with a MatCap; or for one whose
/// triangles are of a few pixels, with colours computed at its vertices.
enum class Fragments : std::size_t { flat, ground, surface, plain, matcap, merged };
inline constexpr std::size_t fragments_count = 6;

/// The texture units of the shaders' samplers. 0 is for all other uses.
enum class Unit : unsigned {
  vertex_places = 1, ///< with the normals: read by index where corners are drawn one by one
  vertex_normals,
  shadows,
  corner_places,
  corner_texcoords,
  corner_tints,
  picture,
  matcap
};

/// Makes a program, with its samplers' units, and returns its name. Error: failed (the shaders do
/// not compile; the message has the log).
Result<unsigned> make_program(Fragments kind);

/// Binds a texture of OpenGL's kind `target` to a unit.
void bind_texture(Unit unit, unsigned target, unsigned texture);

/// Sets a uniform of the program, which must be in use.
void set(unsigned program, const char* name, const Eigen::Matrix4f& value);
void set(unsigned program, const char* name, const Eigen::Matrix3f& value);
void set(unsigned program, const char* name, std::span<const Eigen::Vector4f> values);
void set(unsigned program, const char* name, const Eigen::Vector2f& value);
void set(unsigned program, const char* name, const Eigen::Vector3f& value);
void set(unsigned program, const char* name, float value);
void set(unsigned program, const char* name, int value);

} // namespace nendo::gl
