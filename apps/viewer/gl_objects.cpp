#include "viewer/gl_objects.hpp"

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <map>
#include <string>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

namespace nendo::viewer {

using Eigen::AlignedBox3f;
using Eigen::Matrix4f;
using Eigen::Vector3f;

namespace {

// They use the same lights as lights.cpp, without the sky's shadows. Each kind of fragment has
// a shader of its own: where there is no graphics card, all branches are computed.
constexpr const char* vertex_shader = R"(
invariant gl_Position; // the same in all programs, so that depths are equal
uniform mat4 clip_of_world;
uniform bool from_blocks;
uniform samplerBuffer block_places;   // 64 x, 64 y, 64 z, and again
uniform samplerBuffer block_normals;
uniform samplerBuffer block_colours;
uniform bool vertex_colours;
uniform bool by_corners; // then vertices are counted by corners
uniform bool textured;
uniform usamplerBuffer corner_places;
uniform samplerBuffer corner_texcoords;
uniform bool corner_colours; // in place of the vertices'
uniform samplerBuffer corner_tints;
uniform float scale;
uniform vec3 offset;
uniform vec2 outward; // of clip coordinates, for each pixel of an outline's width; 0: no outline
layout(location = 0) in vec3 given_place;
layout(location = 1) in vec3 given_normal;
out vec3 place;
// At an edge the middle of a pixel may lie outside of the triangle, and far away from it if the
// triangle is seen edge on. These two are of where the triangle is.
centroid out vec3 within;
centroid out vec3 normal;
centroid out vec3 tint;
centroid out vec2 texcoord;
vec3 of_block(samplerBuffer blocks) {
  int vertex = by_corners ? int(texelFetch(corner_places, gl_VertexID).r) : gl_VertexID;
  int at = vertex / 64 * 192 + vertex % 64;
  return vec3(texelFetch(blocks, at).r, texelFetch(blocks, at + 64).r, texelFetch(blocks, at + 128).r);
}
vec3 of_corner(samplerBuffer floats) {
  int at = 3 * gl_VertexID;
  return vec3(texelFetch(floats, at).r, texelFetch(floats, at + 1).r, texelFetch(floats, at + 2).r);
}
void main() {
  place = from_blocks ? scale * of_block(block_places) + offset : given_place;
  normal = from_blocks ? of_block(block_normals) : given_normal;
  texcoord = textured ? texelFetch(corner_texcoords, gl_VertexID).rg : vec2(0.0);
  tint = corner_colours ? of_corner(corner_tints) : vertex_colours ? of_block(block_colours) : vec3(1.0);
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
centroid in vec3 tint;
centroid in vec2 texcoord;
uniform bool textured;
uniform sampler2D picture;
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
void main() {
  vec3 sight = normalize(eye - within);
  vec3 n = toward(sight);
  float across = 1.0 - clamp(dot(n, sight), 0.0, 1.0);
  float part = mix(opacity, rim_opacity, across * across * across);
#ifdef PLAIN
  vec3 own = colour;
#else
  vec3 own = colour * tint;
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
  const auto vertices =
      kind == Fragments::merged
          ? compiled(GL_VERTEX_SHADER, {version,
                                        "#define MERGED\nuniform bool has_matcap;\n"
                                        "out vec3 seen;\n",
                                        light_shader, vertex_shader})
          : compiled(GL_VERTEX_SHADER, {version, vertex_shader});
  if (!vertices) return vertices.error();
  const char* const plain = kind == Fragments::plain ? "#define PLAIN\n" : "";
  const auto fragments = kind == Fragments::flat
                             ? compiled(GL_FRAGMENT_SHADER, {flat_shader})
                             : compiled(GL_FRAGMENT_SHADER, {version, plain, light_shader,
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
  if (linked != 0) return program;
  glDeleteProgram(program);
  return Error{Errc::failed, "this OpenGL cannot link the shaders"};
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

namespace {

/// Returns the name of a texture with the picture; 0 if it is too large for the card.
GLuint texture_with(const render::Image& image) {
  GLint most = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &most);
  const render::Size size = image.size();
  if (std::max(size.width, size.height) > most) return 0;
  GLuint name = 0;
  glGenTextures(1, &name);
  glBindTexture(GL_TEXTURE_2D, name);
  glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_SRGB8, size.width, size.height, 0, GL_RGB, GL_UNSIGNED_BYTE,
               image.pixels().data());
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glGenerateMipmap(GL_TEXTURE_2D);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_LINEAR_MIPMAP_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_S, GL_REPEAT);
  glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_WRAP_T, GL_REPEAT);
  return name;
}

} // namespace

ModelTextures::~ModelTextures() {
  remove();
}

void ModelTextures::remove() {
  std::sort(pictures_.begin(), pictures_.end()); // coats may share one
  pictures_.erase(std::unique(pictures_.begin(), pictures_.end()), pictures_.end());
  glDeleteTextures(static_cast<GLsizei>(pictures_.size()), pictures_.data());
  pictures_.clear();
  glDeleteTextures(3, buffer_textures_.data());
  glDeleteBuffers(3, buffers_.data());
  buffer_textures_ = {};
  buffers_ = {};
}

void ModelTextures::set(const render::Paint& paint, const std::vector<std::uint32_t>& corners) {
  remove();
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(units[3]));
  std::map<const render::TextureImage*, GLuint> made;
  for (const render::Coat& coat : paint.coats()) {
    auto& name = made[coat.texture.get()];
    if (coat.texture && name == 0) name = texture_with(coat.texture->image());
    pictures_.push_back(name);
  }
  if (paint.texcoords().empty() && paint.corner_colours().empty()) return;
  glGenBuffers(3, buffers_.data());
  glGenTextures(3, buffer_textures_.data());
  const auto fill = [&](std::size_t which, GLenum format, const auto& values) {
    if (values.empty()) return;
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(units[which]));
    glBindBuffer(GL_TEXTURE_BUFFER, buffers_[which]);
    glBufferData(GL_TEXTURE_BUFFER, static_cast<GLsizeiptr>(values.size() * sizeof values[0]),
                 values.data(), GL_STATIC_DRAW);
    glBindTexture(GL_TEXTURE_BUFFER, buffer_textures_[which]);
    glTexBuffer(GL_TEXTURE_BUFFER, format, buffers_[which]);
  };
  fill(0, GL_R32UI, corners);
  fill(1, GL_RG32F, paint.texcoords());
  fill(2, GL_R32F, paint.corner_colours()); // OpenGL 3.3 has no buffers of three floats
  glActiveTexture(GL_TEXTURE0);
}

void ModelTextures::bind(unsigned program) const {
  viewer::set(program, "corner_places", units[0]);
  viewer::set(program, "corner_texcoords", units[1]);
  viewer::set(program, "corner_tints", units[2]);
  viewer::set(program, "picture", units[3]);
  for (std::size_t which = 0; which < 3; ++which) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(units[which]));
    glBindTexture(GL_TEXTURE_BUFFER, buffer_textures_[which]);
  }
  glActiveTexture(GL_TEXTURE0);
}

bool ModelTextures::use(std::size_t coat) const {
  if (coat >= pictures_.size() || pictures_[coat] == 0) return false;
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(units[3]));
  glBindTexture(GL_TEXTURE_2D, pictures_[coat]);
  glActiveTexture(GL_TEXTURE0);
  return true;
}

MatCapTextures::MatCapTextures() {
  glGenTextures(static_cast<GLsizei>(names_.size()), names_.data());
  for (std::size_t at = 0; at < names_.size(); ++at) {
    const render::Image image = matcap(static_cast<Material>(at + 1));
    glBindTexture(GL_TEXTURE_2D, names_[at]);
    glTexImage2D(GL_TEXTURE_2D, 0, GL_RGB8, image.size().width, image.size().height, 0, GL_RGB,
                 GL_UNSIGNED_BYTE, image.pixels().data());
    for (const GLenum filter : std::array<GLenum, 2>{GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
      glTexParameteri(GL_TEXTURE_2D, filter, GL_LINEAR);
    for (const GLenum wrap : std::array<GLenum, 2>{GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T})
      glTexParameteri(GL_TEXTURE_2D, wrap, GL_CLAMP_TO_EDGE);
  }
}

MatCapTextures::~MatCapTextures() {
  glDeleteTextures(static_cast<GLsizei>(names_.size()), names_.data());
}

void MatCapTextures::use(Material material) const {
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(unit));
  glBindTexture(GL_TEXTURE_2D, names_[static_cast<std::size_t>(material) - 1]);
  glActiveTexture(GL_TEXTURE0);
}

namespace {

constexpr float min_slack_m = 0.004F; // as in pictures (lights.cpp)
constexpr float edge_samples = 8.0F;  // stay empty, so that the map's edge casts no shadow

} // namespace

ShadowMap::ShadowMap(int side) : side_(side) {
  glGenTextures(1, &texture_);
  glBindTexture(GL_TEXTURE_2D, texture_);
  glTexImage2D(GL_TEXTURE_2D, 0, GL_DEPTH_COMPONENT24, side_, side_, 0, GL_DEPTH_COMPONENT,
               GL_UNSIGNED_INT, nullptr);
  // Outside of the map, everything is lit.
  constexpr std::array<float, 4> lit{1.0F, 1.0F, 1.0F, 1.0F};
  glTexParameterfv(GL_TEXTURE_2D, GL_TEXTURE_BORDER_COLOR, lit.data());
  for (const auto& [name, value] : std::array<std::pair<GLenum, GLenum>, 6>{
           {{GL_TEXTURE_MIN_FILTER, GL_LINEAR},
            {GL_TEXTURE_MAG_FILTER, GL_LINEAR},
            {GL_TEXTURE_WRAP_S, GL_CLAMP_TO_BORDER},
            {GL_TEXTURE_WRAP_T, GL_CLAMP_TO_BORDER},
            {GL_TEXTURE_COMPARE_MODE, GL_COMPARE_REF_TO_TEXTURE},
            {GL_TEXTURE_COMPARE_FUNC, GL_LEQUAL}}})
    glTexParameteri(GL_TEXTURE_2D, name, static_cast<GLint>(value));
  GLint before = 0;
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before);
  glGenFramebuffers(1, &frame_buffer_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
  glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, texture_, 0);
  glDrawBuffer(GL_NONE);
  glReadBuffer(GL_NONE);
  is_there_ = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before));
}

ShadowMap::~ShadowMap() {
  glDeleteFramebuffers(1, &frame_buffer_);
  glDeleteTextures(1, &texture_);
}

bool ShadowMap::begin(const AlignedBox3f& casting, const Vector3f& toward) {
  if (!is_there_ || casting.isEmpty() || !casting.sizes().allFinite()) return false;
  const Vector3f other = std::abs(toward.y()) < 0.9F ? Vector3f::UnitY() : Vector3f::UnitX();
  Eigen::Matrix3f rows;
  rows.row(0) = other.cross(toward).normalized();
  rows.row(1) = toward.cross(Vector3f(rows.row(0).transpose()));
  rows.row(2) = toward;
  AlignedBox3f box; // in the light's axes
  for (int corner = 0; corner < 8; ++corner)
    box.extend(rows * casting.corner(static_cast<AlignedBox3f::CornerType>(corner)));
  const float across = std::max(1e-3F, box.sizes().head<2>().maxCoeff());
  const float sample_m = across / (static_cast<float>(side_) - 2.0F * edge_samples);
  slack_m_ = std::max(min_slack_m, 2.0F * sample_m);
  const float half = static_cast<float>(side_) * sample_m / 2.0F;
  const float half_deep = box.sizes().z() / 2.0F + 2.0F * slack_m_;
  const Vector3f middle = box.center();
  map_of_world_ = Matrix4f::Identity();
  for (int axis = 0; axis < 3; ++axis) {
    const float scale = axis < 2 ? 1.0F / half : -1.0F / half_deep; // the light sees the nearest
    map_of_world_.block<1, 3>(axis, 0) = scale * rows.row(axis);
    map_of_world_(axis, 3) = -scale * middle[axis];
  }
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &before_);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
  glViewport(0, 0, side_, side_);
  // A surface nearly along the light is deeper within a sample than any slack.
  glEnable(GL_POLYGON_OFFSET_FILL);
  glPolygonOffset(3.0F, 4.0F);
  glClear(GL_DEPTH_BUFFER_BIT);
  return true;
}

void ShadowMap::end() const {
  glDisable(GL_POLYGON_OFFSET_FILL);
  glBindFramebuffer(GL_FRAMEBUFFER, static_cast<GLuint>(before_));
}

SmoothTarget::~SmoothTarget() {
  drop();
}

void SmoothTarget::drop() noexcept {
  glDeleteFramebuffers(1, &frame_buffer_);
  glDeleteRenderbuffers(1, &colours_);
  glDeleteRenderbuffers(1, &depths_);
  frame_buffer_ = colours_ = depths_ = 0;
}

void SmoothTarget::make(render::Size size, bool smooth) {
  drop();
  size_ = size;
  smooth_ = smooth;
  GLint most = 0;
  glGetIntegerv(GL_MAX_SAMPLES, &most);
  for (int samples = smooth ? std::min<int>(most, max_samples) : 0; samples >= 0; --samples) {
    glGenFramebuffers(1, &frame_buffer_);
    glGenRenderbuffers(1, &colours_);
    glGenRenderbuffers(1, &depths_);
    glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
    glBindRenderbuffer(GL_RENDERBUFFER, colours_);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_RGBA8, size.width, size.height);
    glBindRenderbuffer(GL_RENDERBUFFER, depths_);
    glRenderbufferStorageMultisample(GL_RENDERBUFFER, samples, GL_DEPTH24_STENCIL8, size.width,
                                     size.height);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, colours_);
    glFramebufferRenderbuffer(GL_FRAMEBUFFER, GL_DEPTH_STENCIL_ATTACHMENT, GL_RENDERBUFFER,
                              depths_);
    const bool complete = glCheckFramebufferStatus(GL_FRAMEBUFFER) == GL_FRAMEBUFFER_COMPLETE;
    glBindFramebuffer(GL_FRAMEBUFFER, 0);
    if (complete) return;
    drop();
  }
}

void SmoothTarget::begin(render::Size size, bool smooth) {
  if (!(size == size_) || smooth != smooth_) make(size, smooth);
  glBindFramebuffer(GL_FRAMEBUFFER, frame_buffer_);
}

void SmoothTarget::end(render::Size shown, int below) const {
  if (frame_buffer_ == 0) return;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, frame_buffer_);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, 0);
  glBlitFramebuffer(0, 0, size_.width, size_.height, 0, below, shown.width, below + shown.height,
                    GL_COLOR_BUFFER_BIT, size_ == shown ? GL_NEAREST : GL_LINEAR);
  glBindFramebuffer(GL_FRAMEBUFFER, 0);
}

} // namespace nendo::viewer
