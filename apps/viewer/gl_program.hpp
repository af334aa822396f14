#pragma once
// OpenGL's programs and their uniforms, in fewer words. All calls belong to the thread that has the
// OpenGL context.

#include <Eigen/Core>

#include <nendo/base/result.hpp>

namespace nendo::viewer {

/// Makes a program of the two shaders' strings and returns its name. Error: failed (this OpenGL
/// refuses them; the message tells why).
Result<unsigned> make_program(const char* vertex, const char* fragment);

/// Sets a uniform of the program, which must be in use.
void set(unsigned program, const char* name, const Eigen::Matrix4f& value);
void set(unsigned program, const char* name, const Eigen::Vector3f& value);
void set(unsigned program, const char* name, float value);
void set(unsigned program, const char* name, int value);

} // namespace nendo::viewer
