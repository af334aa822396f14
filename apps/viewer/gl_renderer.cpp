#include "viewer/gl_renderer.hpp"

#include <algorithm>
#include <string>

#define GL_GLEXT_PROTOTYPES
#include <GL/glcorearb.h>

#include "render/lights.hpp"

namespace nendo::viewer {

using deform::block_size;
using Eigen::Vector3f;

namespace {

constexpr std::size_t block_floats = 3 * block_size;
constexpr int shadow_unit = 3; // after the model's three textures
// In the stencil: what is seen there, not counting hands.
constexpr GLint ground_mark = 0; // or nothing
constexpr GLint solid_mark = 1;  // the model or a solid

bool casts(const render::Surface& surface) {
  return surface.material.opacity > 0.0F && !surface.material.shadowless;
}

// What is beyond, or nowhere, casts no shadow.
void extend(Eigen::AlignedBox3f& box, const Vector3f& place) {
  constexpr float far_m = 1e3F;
  if (place.cwiseAbs().maxCoeff() < far_m) box.extend(place);
}

template <class T>
GLsizeiptr bytes_of(const std::vector<T>& values) {
  return static_cast<GLsizeiptr>(values.size() * sizeof(T));
}

/// Vertices' colours in the order of the blocks: 64 reds, 64 greens, 64 blues, and again. One
/// number if there are none, because a buffer must not be empty.
std::vector<float> colours_in_blocks(const std::vector<Vector3f>& colours,
                                     const std::vector<std::uint32_t>& place_of,
                                     std::size_t blocks) {
  if (colours.empty()) return {1.0F};
  std::vector<float> ordered(blocks * block_floats, 1.0F);
  for (std::size_t vertex = 0; vertex < colours.size(); ++vertex)
    for (std::size_t channel = 0; channel < 3; ++channel)
      ordered[place_of[vertex] / block_size * block_floats + channel * block_size +
              place_of[vertex] % block_size] = colours[vertex][static_cast<Eigen::Index>(channel)];
  return ordered;
}

} // namespace

Result<std::unique_ptr<GlRenderer>> GlRenderer::make() {
  GLint major = 0;
  GLint minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (10 * major + minor < 33)
    return Error{Errc::failed, "OpenGL 3.3 is needed, and this is " + std::to_string(major) + "." +
                                   std::to_string(minor)};
  std::unique_ptr<GlRenderer> renderer(new GlRenderer);
  for (const Fragments kind : {Fragments::white, Fragments::ground, Fragments::surface}) {
    const auto program = make_program(kind);
    if (!program) return program.error();
    renderer->programs_[static_cast<std::size_t>(kind)] = *program;
  }
  glGenVertexArrays(1, &renderer->vertex_array_);
  glGenBuffers(1, &renderer->model_indices_);
  glGenBuffers(3, renderer->model_buffers_.data());
  glGenTextures(3, renderer->model_textures_.data());
  glGenBuffers(3, renderer->stream_.data());
  return renderer;
}

GlRenderer::~GlRenderer() {
  glDeleteBuffers(3, stream_.data());
  glDeleteTextures(3, model_textures_.data());
  glDeleteBuffers(3, model_buffers_.data());
  glDeleteBuffers(1, &model_indices_);
  glDeleteVertexArrays(1, &vertex_array_);
  for (const GLuint program : programs_)
    glDeleteProgram(program);
}

void GlRenderer::set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder) {
  const std::vector<std::uint32_t> place_of = layout.places();
  corners_.clear();
  for (const std::uint32_t corner : builder.corners())
    corners_.push_back(place_of[corner]);
  scale_ = static_cast<float>(layout.unit() / builder.units_per_metre());
  offset_ = (layout.origin() / builder.units_per_metre() - builder.origin_m()).cast<float>();
  const std::size_t blocks = layout.block_count();
  places_.assign(blocks * block_size, Vector3f::Zero());
  normals_.clear();
  paint_ = builder.paint();
  const std::vector<float> colours = colours_in_blocks(paint_->vertex_colours(), place_of, blocks);
  for (std::size_t which = 0; which < 3; ++which) {
    glBindBuffer(GL_TEXTURE_BUFFER, model_buffers_[which]);
    if (which < 2)
      glBufferData(GL_TEXTURE_BUFFER,
                   static_cast<GLsizeiptr>(blocks * block_floats * sizeof(float)), nullptr,
                   GL_DYNAMIC_DRAW);
    else
      glBufferData(GL_TEXTURE_BUFFER, bytes_of(colours), colours.data(), GL_STATIC_DRAW);
    glBindTexture(GL_TEXTURE_BUFFER, model_textures_[which]);
    glTexBuffer(GL_TEXTURE_BUFFER, GL_R32F, model_buffers_[which]);
  }
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, model_indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes_of(corners_), corners_.data(), GL_STATIC_DRAW);
  textures_.set(*paint_, corners_);
  whole_ = false;
  blocks_sent_ = 0;
}

void GlRenderer::follow(const deform::BlockShape& shape) {
  const auto send = [](GLuint buffer, std::size_t block, const float* floats) {
    glBindBuffer(GL_TEXTURE_BUFFER, buffer);
    glBufferSubData(GL_TEXTURE_BUFFER, static_cast<GLintptr>(block * block_floats * sizeof(float)),
                    static_cast<GLsizeiptr>(block_floats * sizeof(float)), floats);
  };
  if (!whole_) shape_ = deform::BlockShape(std::vector<deform::VertexBlock>(shape.block_count()));
  bool changed = false;
  for (std::size_t block = 0; block < shape.block_count(); ++block) {
    if (whole_ && shape_.stamp(block) == shape.stamp(block)) continue;
    shape_.follow(shape, block);
    const deform::VertexBlock& now = shape[block];
    send(model_buffers_[0], block, now.x.data());
    for (std::size_t lane = 0; lane < block_size; ++lane)
      places_[block * block_size + lane] = deform::vertex_in(now, lane);
    ++blocks_sent_;
    changed = true;
  }
  if (!changed) return;
  whole_ = true;
  render::compute_normals(places_, corners_, new_normals_);
  block_.resize(block_floats);
  for (std::size_t block = 0; block < shape.block_count(); ++block) {
    const auto first = static_cast<std::ptrdiff_t>(block * block_size);
    const auto begin = new_normals_.begin() + first;
    const auto end = begin + block_size;
    if (!normals_.empty() && std::equal(begin, end, normals_.begin() + first)) continue;
    for (std::size_t lane = 0; lane < block_size; ++lane)
      for (std::size_t axis = 0; axis < 3; ++axis)
        block_[axis * block_size + lane] =
            begin[static_cast<std::ptrdiff_t>(lane)][static_cast<Eigen::Index>(axis)];
    send(model_buffers_[1], block, block_.data());
  }
  normals_.swap(new_normals_);
  box_.setEmpty();
  for (const Vector3f& place : places_)
    extend(box_, scale_ * place + offset_);
}

void GlRenderer::send_surface(const render::Surface& surface) {
  const std::array<const std::vector<Vector3f>*, 2> vectors{&surface.places, &surface.normals};
  for (GLuint which = 0; which < 2; ++which) {
    glBindBuffer(GL_ARRAY_BUFFER, stream_[which]);
    glBufferData(GL_ARRAY_BUFFER, bytes_of(*vectors[which]), vectors[which]->data(),
                 GL_STREAM_DRAW);
    glEnableVertexAttribArray(which);
    glVertexAttribPointer(which, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, stream_[2]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes_of(surface.corners), surface.corners.data(),
               GL_STREAM_DRAW);
}

void GlRenderer::use(Fragments fragments) {
  program_ = programs_[static_cast<std::size_t>(fragments)];
  glUseProgram(program_);
}

void GlRenderer::use_material(const render::Material& material) {
  if (next_.white)
    use(Fragments::white);
  else
    use(material.grid_m > 0.0F ? Fragments::ground : Fragments::surface);
  set(program_, "facets", next_.facets ? 1 : 0);
  set(program_, "shadowed", next_.shadowed ? 1 : 0);
  set(program_, "colour", material.colour);
  set(program_, "gloss", material.gloss);
  set(program_, "opacity", material.opacity);
  set(program_, "rim_opacity", material.rim_opacity);
  set(program_, "grid", material.grid_m);
  set(program_, "fade", material.fade_m);
  set(program_, "unlit", material.opacity > 0.0F ? 0 : 1);
}

// One call for each colour. Where there is a texture, a vertex has several texture coordinates, and
// it may have several colours; then each corner is drawn by itself, and the shader looks up its
// vertex.
void GlRenderer::draw_model() const {
  set(program_, "vertex_colours", paint_->vertex_colours().empty() ? 0 : 1);
  const bool corner_colours = !paint_->corner_colours().empty();
  set(program_, "corner_colours", corner_colours ? 1 : 0);
  for (std::size_t at = 0; at < paint_->coats().size(); ++at) {
    const render::Coat& coat = paint_->coats()[at];
    const auto count = static_cast<GLsizei>(3 * coat.count);
    set(program_, "colour", coat.colour);
    const bool textured = textures_.use(at);
    set(program_, "textured", textured ? 1 : 0);
    set(program_, "by_corners", textured || corner_colours ? 1 : 0);
    const std::size_t offset = 3 * coat.first * sizeof(std::uint32_t);
    if (textured || corner_colours)
      glDrawArrays(GL_TRIANGLES, static_cast<GLint>(3 * coat.first), count);
    else
      // OpenGL takes offsets as pointers. NOLINTNEXTLINE(performance-no-int-to-ptr)
      glDrawElements(GL_TRIANGLES, count, GL_UNSIGNED_INT, reinterpret_cast<const void*>(offset));
  }
  for (const char* what : {"textured", "by_corners", "vertex_colours", "corner_colours"})
    set(program_, what, 0);
}

void GlRenderer::draw_surface(const render::Surface& surface, bool model) {
  const std::size_t count = model ? corners_.size() : surface.corners.size();
  if (count == 0) return;
  if (model) {
    glDisableVertexAttribArray(0);
    glDisableVertexAttribArray(1);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, model_indices_);
  } else {
    send_surface(surface);
  }
  const bool veil = surface.material.opacity < 1.0F;
  const auto triangles = [&] {
    set(program_, "from_blocks", model ? 1 : 0);
    if (model) return draw_model();
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count), GL_UNSIGNED_INT, nullptr);
  };
  if (!veil) {
    use_material(surface.material);
    triangles();
    return;
  }
  // Depth first, so that only its nearest layer is mixed in.
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  use(Fragments::white);
  triangles();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  use_material(surface.material);
  if (surface.material.opaque_before_ground) {
    glStencilFunc(GL_EQUAL, ground_mark, 0xFF);
    triangles();
    glStencilFunc(GL_EQUAL, solid_mark, 0xFF);
  }
  glEnable(GL_BLEND);
  triangles();
  glDisable(GL_BLEND);
  glStencilFunc(GL_ALWAYS, ground_mark, 0xFF);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
}

template <class Sets>
void GlRenderer::for_each_program(const Sets& sets) {
  for (const Fragments fragments : {Fragments::white, Fragments::ground, Fragments::surface}) {
    use(fragments);
    sets();
  }
}

// Makes the map of the key light's shadow. Returns false if nothing casts a shadow.
bool GlRenderer::cast_shadows(const render::Scene& beside, const Vector3f& key) {
  Eigen::AlignedBox3f box = whole_ ? box_ : Eigen::AlignedBox3f();
  for (const auto* surfaces : {&beside.solids, &beside.veils})
    for (const render::Surface& surface : *surfaces)
      if (casts(surface))
        for (const Vector3f& place : surface.places)
          extend(box, place);
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(shadow_unit));
  glBindTexture(GL_TEXTURE_2D, 0); // nothing may read what is being drawn
  if (!shadows_.begin(box, key)) return false;
  next_ = {};
  next_.white = true;
  use(Fragments::white);
  set(program_, "clip_of_world", shadows_.map_of_world());
  if (whole_) draw_surface(beside.model, true);
  for (const auto* surfaces : {&beside.solids, &beside.veils})
    for (const render::Surface& surface : *surfaces)
      if (casts(surface)) draw_surface(surface, false);
  shadows_.end();
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(shadow_unit));
  glBindTexture(GL_TEXTURE_2D, shadows_.texture());
  return true;
}

void GlRenderer::use_model() {
  set(program_, "scale", scale_);
  set(program_, "offset", offset_);
  set(program_, "block_places", 0);
  set(program_, "block_normals", 1);
  set(program_, "block_colours", 2);
  textures_.bind(program_);
  for (std::size_t which = 0; which < 3; ++which) {
    glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(which));
    glBindTexture(GL_TEXTURE_BUFFER, model_textures_[which]);
  }
}

void GlRenderer::draw(const render::Scene& beside, const render::Camera& camera, render::Size size,
                      Look look) {
  const bool shaded = look != Look::silhouette;
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(vertex_array_);
  for_each_program([&] { use_model(); });
  const Vector3f key = render::turned(render::key_direction, camera.view.azimuth_deg);
  const bool shadowed = shaded && cast_shadows(beside, key);
  glViewport(0, 0, size.width, size.height);
  glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
  if (shaded) glClearColor(0.90F, 0.91F, 0.92F, 1.0F);
  glClearStencil(ground_mark);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  const Eigen::Matrix4f clip = camera.projection(1.0 * size.width / size.height).cast<float>();
  for_each_program([&] {
    set(program_, "clip_of_world", clip);
    set(program_, "map_of_world", shadows_.map_of_world());
    set(program_, "slack", shadows_.slack_m());
    set(program_, "shadows", shadow_unit);
    set(program_, "eye", Vector3f(camera.eye().cast<float>()));
    set(program_, "key", key);
    set(program_, "fill", render::turned(render::fill_direction, camera.view.azimuth_deg));
    set(program_, "rim", render::turned(render::rim_direction, camera.view.azimuth_deg));
    set(program_, "height", static_cast<float>(size.height));
  });
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  draw_parts(beside, look, shadowed);
  glDisable(GL_STENCIL_TEST);
}

void GlRenderer::draw_parts(const render::Scene& beside, Look look, bool shadowed) {
  const bool shaded = look != Look::silhouette;
  const auto receives = [&](bool yes) { next_.shadowed = yes && shadowed; };
  next_ = {};
  next_.white = !shaded;
  const auto mark = [](GLint as) { glStencilFunc(GL_ALWAYS, as, 0xFF); };
  receives(true);
  mark(solid_mark);
  next_.facets = look == Look::facets;
  if (whole_) draw_surface(beside.model, true);
  next_.facets = false;
  mark(ground_mark);
  if (shaded)
    for (const render::Surface& ground : beside.grounds)
      draw_surface(ground, false);
  mark(solid_mark);
  receives(false); // bones lie in the shadow of their skin
  for (const render::Surface& solid : beside.solids)
    draw_surface(solid, false);
  receives(true);
  mark(ground_mark);
  // Hands, then what has no depth of its own.
  for (const bool reaches : {false, true})
    for (const render::Surface& veil : beside.veils)
      if (casts(veil) != reaches && (shaded || !reaches)) draw_surface(veil, false);
  glActiveTexture(GL_TEXTURE0);
}

} // namespace nendo::viewer
