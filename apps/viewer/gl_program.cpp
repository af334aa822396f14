#include "viewer/gl_program.hpp"

#include <algorithm>
#include <string>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

namespace nendo::viewer {
namespace {

Result<GLuint> compiled(GLenum kind, const char* text) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint fine = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &fine);
  if (fine != 0) return shader;
  std::string log(1000, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), &length, log.data());
  log.resize(static_cast<std::size_t>(length));
  std::replace(log.begin(), log.end(), '\n', ' ');
  return Error{Errc::failed, "this OpenGL refuses a shader: " + log};
}

} // namespace

Result<unsigned> make_program(const char* vertex, const char* fragment) {
  const auto vertex_shader = compiled(GL_VERTEX_SHADER, vertex);
  if (!vertex_shader) return vertex_shader.error();
  const auto fragment_shader = compiled(GL_FRAGMENT_SHADER, fragment);
  if (!fragment_shader) return fragment_shader.error();
  const GLuint program = glCreateProgram();
  for (const GLuint shader : {*vertex_shader, *fragment_shader}) {
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked != 0) return program;
  glDeleteProgram(program);
  return Error{Errc::failed, "this OpenGL cannot link the shaders"};
}

void set(unsigned program, const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, value.data());
}
void set(unsigned program, const char* name, const Eigen::Vector3f& value) {
  glUniform3f(glGetUniformLocation(program, name), value.x(), value.y(), value.z());
}
void set(unsigned program, const char* name, float value) {
  glUniform1f(glGetUniformLocation(program, name), value);
}
void set(unsigned program, const char* name, int value) {
  glUniform1i(glGetUniformLocation(program, name), value);
}

} // namespace nendo::viewer
