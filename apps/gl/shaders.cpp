#include "gl/shaders.hpp"

#include <algorithm>
#include <array>
#include <initializer_list>
#include <string>
#include <utility>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

namespace nendo::gl {

namespace {

// They use the same lights as lights.cpp, without the sky's shadows. Each kind of fragment has
// a shader of its own: where there is no graphics card, all branches are computed.
constexpr const char* vertex_shader = R"(
invariant gl_Position; // the same in all programs, so that depths are equal
uniform mat4 clip_of_world;
uniform vec2 outward; // of clip coordinates, for each pixel of an outline's width; 0: no outline
layout(location = 0) in vec3 given_place;
layout(location = 1) in vec3 given_normal;
out vec3 place;
// At an edge the middle of a pixel may lie outside of the triangle, and far away from it if the
// triangle is seen edge on. These two are of where the triangle is.
centroid out vec3 within;
centroid out vec3 normal;
#ifdef COATS
layout(location = 2) in vec3 given_tint;
uniform bool by_corners; // then vertices are counted by corners, which have their own coordinates and colours
uniform samplerBuffer vertex_places, vertex_normals, corner_texcoords, corner_tints;
uniform usamplerBuffer corner_places;
centroid out vec3 tint;
centroid out vec2 texcoord;
vec3 three(samplerBuffer floats, int which) {
  return vec3(texelFetch(floats, 3 * which).r, texelFetch(floats, 3 * which + 1).r, texelFetch(floats, 3 * which + 2).r);
}
#endif
void main() {
  place = given_place;
  normal = given_normal;
#ifdef COATS
  tint = given_tint;
  texcoord = vec2(0.0);
  if (by_corners) {
    int vertex = int(texelFetch(corner_places, gl_VertexID).r);
    place = three(vertex_places, vertex);
    normal = three(vertex_normals, vertex);
    tint = three(corner_tints, gl_VertexID);
    texcoord = texelFetch(corner_texcoords, gl_VertexID).rg;
  }
#endif
  within = place;
  gl_Position = clip_of_world * vec4(place, 1.0);
  if (outward.x > 0.0) {
    vec4 along = clip_of_world * vec4(normal, 0.0);
    vec2 way = (along.xy - along.w * gl_Position.xy / gl_Position.w) / outward;
    gl_Position.xy += way / max(length(way), 1e-9) * outward * gl_Position.w;
  }
#ifdef MERGED
  vec3 sight = normalize(eye - place);
  vec3 n = normal - min(dot(normal, sight), 0.0) * sight; // at an outline it may lean away
  n = length(n) > 0.0 ? normalize(n) : sight;
  seen = has_matcap ? matcap_colour(place, n, sight) : lit_colour(colour, place, n, sight);
#endif
}
)";

/// Of depths, silhouettes and outlines.
constexpr const char* flat_shader = R"(#version 330
uniform vec3 colour;
out vec4 shown;
void main() { shown = vec4(colour, 1.0); }
)";

/// Colours in the lights, of fragments or vertices.
constexpr const char* light_shader = R"(
uniform vec3 eye, colour, key, fill, rim;
uniform float gloss;
uniform bool shadowed, is_quick;
uniform mat4 map_of_world;
uniform float slack;
uniform sampler2DShadow shadows;
uniform sampler2D matcap;
uniform mat3 eye_of_world;
vec3 screen(vec3 linear) {
  vec3 soft = mix(linear, 0.8 + (linear - 0.8) / (1.0 + (linear - 0.8) / 0.2), greaterThan(linear, vec3(0.8)));
  return pow(max(soft, 0.0), vec3(1.0 / 2.2));
}
// How much of the key light reaches the place. Samples round about make the shadow's edge soft.
float lit_part(vec3 at, vec3 n) {
  if (!shadowed) return 1.0;
  vec3 on = 0.5 + 0.5 * (map_of_world * vec4(at + slack * (n + key), 1.0)).xyz;
  on.z = min(on.z, 1.0);
  if (on.x < 0.0 || on.y < 0.0 || on.x > 1.0 || on.y > 1.0) return 1.0; // most of the ground
  if (is_quick) return textureLod(shadows, on, 0.0);
  // Each of the four is smoothed between its four samples by the card.
  vec2 step = 1.0 / vec2(textureSize(shadows, 0));
  float lit = 0.0;
  for (int y = -1; y <= 1; y += 2)
    for (int x = -1; x <= 1; x += 2)
      lit += textureLod(shadows, vec3(on.xy + step * vec2(x, y), on.z), 0.0);
  return lit / 4.0;
}
vec3 lit_colour(vec3 own, vec3 at, vec3 n, vec3 sight) {
  float across = 1.0 - clamp(dot(n, sight), 0.0, 1.0);
  vec3 light = vec3(0.54 * (0.71 + 0.29 * n.y));
  float lit = dot(n, key) > -0.12 ? lit_part(at, n) : 0.0;
  light += lit * max(0.0, (dot(n, key) + 0.12) / 1.12) * vec3(1.42, 1.35, 1.25);
  light += max(0.0, (dot(n, fill) + 0.3) / 1.3) * vec3(0.22, 0.27, 0.34);
  light += across * across * max(0.0, (dot(n, rim) + 0.2) / 1.2) * vec3(0.62, 0.66, 0.72);
  float highlight = pow(max(0.0, dot(n, normalize(key + sight))), 32.0);
  return screen(own * light + gloss * lit * highlight * vec3(1.42, 1.35, 1.25));
}
vec3 matcap_colour(vec3 at, vec3 n, vec3 sight) {
  // The normal in axes of which the third is the line of sight, so that a sphere looks like the
  // picture wherever it is seen.
  vec3 s = eye_of_world * sight, m = eye_of_world * n;
  float a = 1.0 / (1.0 + s.z), b = -s.x * s.y * a;
  vec2 on = vec2(dot(vec3(1.0 - s.x * s.x * a, b, -s.x), m), dot(vec3(b, 1.0 - s.y * s.y * a, -s.y), m));
  vec3 seen = textureLod(matcap, 0.5 + 0.496 * vec2(on.x, -on.y), 0.0).rgb;
  // What a hand or another part of the model casts; that the surface turns away is in the picture.
  float shade = 0.35 * smoothstep(-0.1, 0.4, dot(n, key));
  return shade > 0.0 ? seen * (1.0 - shade * (1.0 - lit_part(at, n))) : seen;
}
)";

/// What the fragments of grounds and surfaces share. After light_shader.
constexpr const char* fragment_shader = R"(
uniform float opacity, rim_opacity, grid, fade, height;
uniform bool unlit, facets;
in vec3 place;
centroid in vec3 within;
centroid in vec3 normal;
out vec4 shown;
// A smooth normal may lean away from the eye at an outline. So the triangle's own side counts:
// turning that normal to the eye would light single pixels from behind.
vec3 toward(vec3 sight) {
  vec3 side = cross(dFdx(place), dFdy(place));
  if (dot(side, sight) < 0.0) side = -side;
  vec3 n = length(normal) > 0.0 ? normalize(normal) : sight;
  if (dot(n, side) < 0.0) n = -n;
  return facets ? normalize(side) : n;
}
// Spheres: a place and a radius. Their union's line on the surface is drawn.
const int max_reaches = 10;
uniform vec4 reaches[max_reaches]; // those that are not in use are far away
uniform int reach_count;
uniform float line_width; // pixels
uniform vec3 accent;
vec3 with_line(vec3 seen) {
  if (reach_count == 0) return seen;
  // Near a sphere this is the distance from it, and takes no root. A loop of a fixed length
  // is unrolled.
  float outside = 1e9;
  for (int at = 0; at < max_reaches; ++at) {
    vec3 way = place - reaches[at].xyz;
    outside = min(outside, dot(way, way) * 0.5 / reaches[at].w - 0.5 * reaches[at].w);
  }
  float off = abs(outside) / max(length(vec2(dFdx(outside), dFdy(outside))), 1e-9);
  return mix(seen, accent, clamp(0.5 * line_width + 0.5 - off, 0.0, 1.0));
}
)";

/// After fragment_shader.
constexpr const char* ground_shader = R"(
// As on the screen: one root for all three colours, for the ground fills most of a picture.
vec3 background() {
  float t = smoothstep(0.0, 1.0, 1.0 - gl_FragCoord.y / height);
  return mix(vec3(0.927, 0.934, 0.939), vec3(0.850, 0.850, 0.848), t);
}
float line(float coordinate) {
  float width = max(0.0015, fwidth(coordinate));
  float off = abs(fract(coordinate / grid + 0.5) - 0.5) * grid;
  return clamp((width - off) / width + 0.5, 0.0, 1.0) * 0.0015 / width;
}
void main() {
  float near = clamp(1.25 - 1.25 * length(place.xz) / fade, 0.0, 1.0);
  float drawn = max(line(place.x), line(place.z));
  float lit = lit_part(place, vec3(0.0, 1.0, 0.0));
  float bright = 0.9 * (0.68 + 0.32 * lit) * (1.0 - 0.3 * drawn);
  shown = vec4(background() * pow(mix(1.0, bright, near), 1.0 / 2.2), 1.0);
}
)";

/// After fragment_shader.
constexpr const char* surface_shader = R"(
#ifdef COATS
centroid in vec3 tint;
centroid in vec2 texcoord;
uniform bool textured;
uniform sampler2D picture;
#endif
void main() {
  vec3 sight = normalize(eye - within);
  vec3 n = toward(sight);
  float across = 1.0 - clamp(dot(n, sight), 0.0, 1.0);
  float part = mix(opacity, rim_opacity, across * across * across);
  vec3 own = colour;
#ifdef COATS
  own *= tint;
  // Its rows begin at the top, and texture coordinates at the bottom.
  vec3 seen = texture(picture, vec2(texcoord.x, 1.0 - texcoord.y)).rgb;
  if (textured) own *= seen;
#endif
  if (unlit) { shown = vec4(screen(colour), part); return; }
  shown = vec4(with_line(lit_colour(own, within, n, sight)), part);
}
)";

/// After fragment_shader.
constexpr const char* matcap_shader = R"(
void main() {
  vec3 sight = normalize(eye - within);
  shown = vec4(with_line(matcap_colour(within, toward(sight), sight)), 1.0);
}
)";

/// Of colours that the vertices have. After fragment_shader.
constexpr const char* merged_shader = R"(
in vec3 seen;
void main() { shown = vec4(with_line(seen), 1.0); }
)";

constexpr const char* version = "#version 330\n";

constexpr std::array<std::pair<const char*, Unit>, 8> samplers{
    {{"vertex_places", Unit::vertex_places},
     {"vertex_normals", Unit::vertex_normals},
     {"shadows", Unit::shadows},
     {"corner_places", Unit::corner_places},
     {"corner_texcoords", Unit::corner_texcoords},
     {"corner_tints", Unit::corner_tints},
     {"picture", Unit::picture},
     {"matcap", Unit::matcap}}};

const char* main_of(Fragments kind) {
  switch (kind) {
  case Fragments::ground:
    return ground_shader;
  case Fragments::matcap:
    return matcap_shader;
  case Fragments::merged:
    return merged_shader;
  default:
    return surface_shader;
  }
}

/// The shader's text consists of the given parts.
Result<GLuint> compiled(GLenum kind, std::initializer_list<const char*> parts) {
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, static_cast<GLsizei>(parts.size()), parts.begin(), nullptr);
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

Result<unsigned> make_program(Fragments kind) {
  const char* const coats = kind == Fragments::surface ? "#define COATS\n" : "";
  const auto vertices =
      kind == Fragments::merged
          ? compiled(GL_VERTEX_SHADER, {version,
                                        "#define MERGED\nuniform bool has_matcap;\n"
                                        "out vec3 seen;\n",
                                        light_shader, vertex_shader})
          : compiled(GL_VERTEX_SHADER, {version, coats, vertex_shader});
  if (!vertices) return vertices.error();
  const auto fragments = kind == Fragments::flat
                             ? compiled(GL_FRAGMENT_SHADER, {flat_shader})
                             : compiled(GL_FRAGMENT_SHADER, {version, coats, light_shader,
                                                             fragment_shader, main_of(kind)});
  if (!fragments) return fragments.error();
  const GLuint program = glCreateProgram();
  for (const GLuint shader : {*vertices, *fragments}) {
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  GLint linked = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &linked);
  if (linked == 0) {
    glDeleteProgram(program);
    return Error{Errc::failed, "this OpenGL cannot link the shaders"};
  }
  glUseProgram(program);
  for (const auto& [name, unit] : samplers)
    set(program, name, static_cast<int>(unit));
  return program;
}

void bind_texture(Unit unit, unsigned target, unsigned texture) {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(target, texture);
  glActiveTexture(GL_TEXTURE0);
}

void set(unsigned program, const char* name, const Eigen::Matrix4f& value) {
  glUniformMatrix4fv(glGetUniformLocation(program, name), 1, GL_FALSE, value.data());
}
void set(unsigned program, const char* name, const Eigen::Matrix3f& value) {
  glUniformMatrix3fv(glGetUniformLocation(program, name), 1, GL_FALSE, value.data());
}
void set(unsigned program, const char* name, std::span<const Eigen::Vector4f> values) {
  if (values.empty()) return;
  glUniform4fv(glGetUniformLocation(program, name), static_cast<GLsizei>(values.size()),
               values.front().data());
}
void set(unsigned program, const char* name, const Eigen::Vector2f& value) {
  glUniform2f(glGetUniformLocation(program, name), value.x(), value.y());
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

} // namespace nendo::gl
