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
constexpr GLint ground_mark = 0;   // or nothing
constexpr GLint solid_mark = 1;    // the model or a solid
constexpr GLint outlined_mark = 2; // in addition, until the outline is drawn
constexpr std::array all_fragments{Fragments::flat,  Fragments::ground, Fragments::surface,
                                   Fragments::plain, Fragments::matcap, Fragments::merged};

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

/// Returns whether each edge of the triangles belongs to two, which go along it in opposite
/// directions, and the surface encloses a positive volume: then what faces away is never seen.
bool is_closed(const std::vector<std::uint32_t>& corners, const std::vector<Vector3f>& places) {
  std::vector<std::uint64_t> edges; // each in the direction of its triangle, and the other way
  edges.reserve(corners.size());
  double volume = 0.0;
  for (std::size_t at = 0; at + 2 < corners.size(); at += 3) {
    for (std::size_t side = 0; side < 3; ++side)
      edges.push_back(std::uint64_t{corners[at + side]} << 32 | corners[at + (side + 1) % 3]);
    volume += static_cast<double>(
        places[corners[at]].dot(places[corners[at + 1]].cross(places[corners[at + 2]])));
  }
  std::sort(edges.begin(), edges.end());
  return volume > 0.0 && std::adjacent_find(edges.begin(), edges.end()) == edges.end() &&
         std::all_of(edges.begin(), edges.end(), [&](std::uint64_t edge) {
           return std::binary_search(edges.begin(), edges.end(), edge << 32 | edge >> 32);
         });
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
  for (const Fragments kind : all_fragments) {
    const auto program = make_program(kind);
    if (!program) return program.error();
    renderer->programs_[static_cast<std::size_t>(kind)] = *program;
  }
  glGenVertexArrays(1, &renderer->vertex_array_);
  glGenBuffers(1, &renderer->model_indices_);
  glGenBuffers(1, &renderer->coarse_indices_);
  glGenBuffers(3, renderer->model_buffers_.data());
  glGenTextures(3, renderer->model_textures_.data());
  glGenBuffers(3, renderer->stream_.data());
  return renderer;
}

GlRenderer::~GlRenderer() {
  glDeleteBuffers(3, stream_.data());
  glDeleteTextures(3, model_textures_.data());
  glDeleteBuffers(3, model_buffers_.data());
  glDeleteBuffers(1, &coarse_indices_);
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
  style_ = {};
  outlined_.clear();
  is_closed_.reset();
  coarse_cubes_ = 0;
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
  if (next_.flat) {
    use(Fragments::flat);
    set(program_, "colour", Vector3f(Vector3f::Ones()));
    return;
  }
  const bool has_matcap = next_.is_model && style_.material != Material::lit;
  use(is_merged()                         ? Fragments::merged
      : has_matcap                        ? Fragments::matcap
      : material.grid_m > 0.0F            ? Fragments::ground
      : next_.is_model && !has_one_coat() ? Fragments::surface
                                          : Fragments::plain);
  set(program_, "has_matcap", has_matcap ? 1 : 0);
  if (has_matcap) matcaps_.use(style_.material);
  std::vector<Eigen::Vector4f> reaches = style_.reaches;
  reaches.resize(Style::max_reaches, Eigen::Vector4f(0.0F, 0.0F, 1e6F, 1.0F)); // far away
  set(program_, "reach_count", next_.is_model ? static_cast<int>(style_.reaches.size()) : 0);
  set(program_, "reaches", reaches);
  set(program_, "facets", next_.is_model && style_.facets ? 1 : 0);
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
  const bool is_coarse = model && is_coarse_here();
  const std::size_t count = is_coarse ? coarse_count_
                            : model   ? corners_.size()
                                      : surface.corners.size();
  if (count == 0) return;
  if (model) {
    glDisableVertexAttribArray(0);
    glDisableVertexAttribArray(1);
    glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, is_coarse ? coarse_indices_ : model_indices_);
  } else {
    send_surface(surface);
  }
  const bool veil = surface.material.opacity < 1.0F;
  const auto triangles = [&] {
    set(program_, "from_blocks", model ? 1 : 0);
    if (model && program_ == programs_[static_cast<std::size_t>(Fragments::surface)])
      return draw_model();
    if (model && !next_.flat) set(program_, "colour", paint_->coats().front().colour);
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
  use(Fragments::flat);
  triangles();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  use_material(surface.material);
  if (surface.material.opaque_before_ground) {
    glStencilFunc(GL_EQUAL, ground_mark, solid_mark);
    triangles();
    glStencilFunc(GL_EQUAL, solid_mark, solid_mark);
  }
  glEnable(GL_BLEND);
  triangles();
  glDisable(GL_BLEND);
  glStencilFunc(GL_ALWAYS, ground_mark, 0xFF);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
}

template <class Sets>
void GlRenderer::for_each_program(const Sets& sets) {
  for (const Fragments fragments : all_fragments) {
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
  if (!shadows_->begin(box, key)) return false;
  next_.flat = true;
  use(Fragments::flat);
  set(program_, "clip_of_world", shadows_->map_of_world());
  if (whole_) draw_closed(beside.model, true);
  for (const render::Surface& solid : beside.solids)
    if (casts(solid)) draw_surface(solid, false);
  for (const render::Surface& skin : beside.veils)
    if (casts(skin)) draw_closed(skin, false);
  shadows_->end();
  glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(shadow_unit));
  glBindTexture(GL_TEXTURE_2D, shadows_->texture());
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

void GlRenderer::set_style(const Style& style) {
  const bool is_same = style.outlined == style_.outlined && style.parts == style_.parts;
  style_ = style;
  if (is_same) return;
  outlined_.clear();
  if (!style.parts) return;
  for (std::size_t at = 0; at + 2 < corners_.size(); at += 3) {
    const std::uint32_t part = style.parts->at_place(corners_[at]);
    if (part != deform::no_index &&
        std::count(style.outlined.begin(), style.outlined.end(), part) > 0)
      outlined_.insert(outlined_.end(), &corners_[at], &corners_[at] + 3);
  }
}

void GlRenderer::begin_picture() {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(vertex_array_);
  for_each_program([&] { use_model(); });
}

/// Also clears the framebuffer.
void GlRenderer::set_view(const render::Camera& camera, render::Size size) {
  glViewport(0, 0, size.width, size.height);
  glClearStencil(ground_mark);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  const Eigen::Matrix4f clip = camera.projection(1.0 * size.width / size.height).cast<float>();
  for_each_program([&] { set(program_, "clip_of_world", clip); });
}

// What the hands or the camera move is drawn coarser, if its triangles are only a few pixels wide.
// It is chosen by the shape as it was when it rested.
void GlRenderer::coarsen(const render::Camera& camera, render::Size size) {
  constexpr double coarse_px = 6.0;
  constexpr int max_cubes = 200;
  const double across_m = 2.0 * camera.tangent() * camera.distance_m; // of the picture's height
  const double longest_px = static_cast<double>(box_.sizes().maxCoeff()) * size.height / across_m;
  const int cubes = static_cast<int>(std::clamp(longest_px / coarse_px, 1.0, max_cubes + 1.0));
  if (4 * std::abs(cubes - coarse_cubes_) < coarse_cubes_) return;
  if (!is_closed_) is_closed_ = is_closed(corners_, places_);
  coarse_cubes_ = cubes;
  coarse_count_ = 0;
  if (cubes > max_cubes) return;
  const std::vector<std::uint32_t> corners = render::coarse_corners(places_, corners_, cubes);
  if (2 * corners.size() > corners_.size()) return; // saves little
  coarse_count_ = corners.size();
  glBindVertexArray(vertex_array_);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, coarse_indices_);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes_of(corners), corners.data(), GL_STATIC_DRAW);
}

bool GlRenderer::is_coarse_here() const noexcept {
  return coarse_count_ > 0 && (next_.flat || style_.material != Material::lit || has_one_coat());
}

bool GlRenderer::is_merged() const noexcept {
  return next_.is_model && is_closed_.value_or(false) && is_coarse_here();
}

bool GlRenderer::has_one_coat() const noexcept {
  return paint_->coats().size() == 1 && paint_->texcoords().empty() &&
         paint_->vertex_colours().empty() && paint_->corner_colours().empty();
}

// What faces away from the eye is hidden by a closed surface's other side.
void GlRenderer::draw_closed(const render::Surface& surface, bool model) {
  if (next_.is_quick && (!model || is_closed_.value_or(false))) glEnable(GL_CULL_FACE);
  draw_surface(surface, model);
  glDisable(GL_CULL_FACE);
}

void GlRenderer::draw(const render::Scene& beside, const render::Camera& camera, render::Size size,
                      const Style& style, bool is_quick) {
  set_style(style);
  begin_picture();
  next_ = {};
  next_.is_quick = is_quick;
  shadows_ = is_quick ? &coarse_shadows_ : &fine_shadows_;
  if (is_quick && whole_ && !style.facets) {
    coarsen(camera, size);
  } else {
    coarse_cubes_ = 0;
    coarse_count_ = 0;
  }
  const double azimuth_deg = camera.view.azimuth_deg;
  const Vector3f key = render::turned(render::key_direction, azimuth_deg);
  const bool shadowed = cast_shadows(beside, key);
  glClearColor(0.90F, 0.91F, 0.92F, 1.0F);
  set_view(camera, size);
  for_each_program([&] {
    set(program_, "map_of_world", shadows_->map_of_world());
    set(program_, "slack", shadows_->slack_m());
    set(program_, "shadows", shadow_unit);
    set(program_, "is_quick", is_quick ? 1 : 0);
    set(program_, "matcap", MatCapTextures::unit);
    set(program_, "eye", Vector3f(camera.eye().cast<float>()));
    set(program_, "eye_of_world", Eigen::Matrix3f(camera.axes().cast<float>()));
    set(program_, "key", key);
    set(program_, "fill", render::turned(render::fill_direction, azimuth_deg));
    set(program_, "rim", render::turned(render::rim_direction, azimuth_deg));
    set(program_, "height", static_cast<float>(size.height));
    set(program_, "accent", style.accent);
    set(program_, "line_width", style.line_width_px);
  });
  glEnable(GL_STENCIL_TEST);
  glStencilOp(GL_KEEP, GL_KEEP, GL_REPLACE);
  next_.flat = false;
  next_.is_model = true;
  next_.shadowed = shadowed;
  glStencilFunc(GL_ALWAYS, solid_mark, 0xFF);
  if (whole_) draw_closed(beside.model, true);
  if (whole_ && !outlined_.empty()) draw_outline(size);
  draw_parts(beside, shadowed);
  glDisable(GL_STENCIL_TEST);
}

void GlRenderer::draw_silhouette(const render::Scene& beside, const render::Camera& camera,
                                 render::Size size) {
  begin_picture();
  glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
  set_view(camera, size);
  next_ = {};
  next_.flat = true;
  if (whole_) draw_surface(beside.model, true);
  for (const render::Surface& solid : beside.solids)
    draw_surface(solid, false);
  for (const render::Surface& veil : beside.veils)
    if (casts(veil)) draw_surface(veil, false);
}

// Marks where the triangles are seen, and draws them, larger by the line's width, beside the marks.
void GlRenderer::draw_outline(render::Size size) {
  use(Fragments::flat);
  set(program_, "from_blocks", 1);
  set(program_, "colour", style_.accent);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, stream_[2]);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, bytes_of(outlined_), outlined_.data(), GL_STREAM_DRAW);
  const auto triangles = [&] {
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(outlined_.size()), GL_UNSIGNED_INT, nullptr);
  };
  glStencilMask(outlined_mark);
  glStencilFunc(GL_ALWAYS, outlined_mark, outlined_mark);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  triangles();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glStencilMask(solid_mark);
  glStencilFunc(GL_NOTEQUAL, outlined_mark | solid_mark, outlined_mark);
  const float width = 2.0F * style_.line_width_px;
  set(program_, "outward",
      Eigen::Vector2f(width / static_cast<float>(size.width),
                      width / static_cast<float>(size.height)));
  triangles();
  set(program_, "outward", Eigen::Vector2f(Eigen::Vector2f::Zero()));
  glStencilMask(0xFF);
}

/// Draws all but the model.
void GlRenderer::draw_parts(const render::Scene& beside, bool shadowed) {
  next_.is_model = false;
  const auto receives = [&](bool yes) { next_.shadowed = yes && shadowed; };
  const auto mark = [](GLint as) { glStencilFunc(GL_ALWAYS, as, solid_mark); };
  receives(true);
  mark(ground_mark);
  for (const render::Surface& ground : beside.grounds)
    draw_surface(ground, false);
  mark(solid_mark);
  receives(false); // bones lie in the shadow of their skin
  for (const render::Surface& solid : beside.solids)
    draw_surface(solid, false);
  receives(true);
  mark(ground_mark);
  for (const render::Surface& veil : beside.veils)
    if (casts(veil)) draw_closed(veil, false); // a hand
  for (const render::Surface& veil : beside.veils)
    if (!casts(veil)) draw_surface(veil, false);
  glActiveTexture(GL_TEXTURE0);
}

} // namespace nendo::viewer
