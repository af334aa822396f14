#pragma once
// Filling of OpenGL's buffers. All calls: the thread with the OpenGL context.

#include <vector>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

namespace nendo::gl {

/// Binds the buffer to the target and replaces its contents.
template <class T>
void fill_buffer(GLenum target, GLuint buffer, const std::vector<T>& values, GLenum usage) {
  glBindBuffer(target, buffer);
  glBufferData(target, static_cast<GLsizeiptr>(values.size() * sizeof(T)), values.data(), usage);
}

} // namespace nendo::gl
