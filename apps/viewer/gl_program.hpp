#pragma once
// OpenGL's programs and their uniforms. All calls belong to the thread that has the
// OpenGL context.

#include <cstddef>

#include <Eigen/Core>

#include <nendo/base/result.hpp>

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

} // namespace nendo::viewer
