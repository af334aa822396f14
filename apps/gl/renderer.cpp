#include "gl/renderer.hpp"

#include <algorithm>
#include <string>

#include "gl/buffers.hpp"
#include "render/lights.hpp"

namespace nendo::gl {

using Eigen::Vector3f;

namespace {

// In the stencil: what is seen there, not counting hands.
constexpr GLint ground_mark = 0;   // or nothing
constexpr GLint solid_mark = 1;    // the model or a solid
constexpr GLint outlined_mark = 2; // in addition, until the outline is drawn
constexpr std::array all_fragments{Fragments::flat,  Fragments::ground, Fragments::surface,
                                   Fragments::plain, Fragments::matcap, Fragments::merged};

bool casts(const render::Surface& surface) {
  return surface.material.opacity > 0.0F && !surface.material.shadowless;
}

// Places beyond, or nowhere, cast no shadow.
void extend(Eigen::AlignedBox3f& box, const Vector3f& place) {
  constexpr float far_m = 1e3F;
  if (place.cwiseAbs().maxCoeff() < far_m) box.extend(place);
}

} // namespace

Result<std::unique_ptr<Renderer>> Renderer::make() {
  GLint major = 0;
  GLint minor = 0;
  glGetIntegerv(GL_MAJOR_VERSION, &major);
  glGetIntegerv(GL_MINOR_VERSION, &minor);
  if (10 * major + minor < 33)
    return Error{Errc::failed, "OpenGL 3.3 is needed, and this is " + std::to_string(major) + "." +
                                   std::to_string(minor)};
  std::unique_ptr<Renderer> renderer(new Renderer);
  for (const Fragments kind : all_fragments) {
    const auto program = make_program(kind);
    if (!program) return program.error();
    renderer->programs_[static_cast<std::size_t>(kind)] = *program;
  }
  for (std::size_t at = 1; at < material_names.size(); ++at)
    renderer->matcaps_.push_back(std::make_unique<Picture>(matcap(static_cast<Material>(at))));
  glGenVertexArrays(1, &renderer->vertex_array_);
  glGenBuffers(3, renderer->stream_.data());
  return renderer;
}

Renderer::~Renderer() {
  glDeleteBuffers(3, stream_.data());
  glDeleteVertexArrays(1, &vertex_array_);
  for (const GLuint program : programs_)
    glDeleteProgram(program);
}

void Renderer::set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder) {
  model_.set(layout, builder);
  style_ = {};
  outlined_.clear();
}

void Renderer::use(Fragments fragments) {
  program_ = programs_[static_cast<std::size_t>(fragments)];
  glUseProgram(program_);
}

void Renderer::use_material(const render::Material& material) {
  if (next_.flat) {
    use(Fragments::flat);
    set(program_, "colour", Vector3f(Vector3f::Ones()));
    return;
  }
  const bool has_matcap = next_.is_model && style_.material != Material::lit;
  const bool is_merged = next_.is_model && model_.is_closed() && is_coarse_here();
  use(is_merged                                  ? Fragments::merged
      : has_matcap                               ? Fragments::matcap
      : material.grid_m > 0.0F                   ? Fragments::ground
      : next_.is_model && !model_.has_one_coat() ? Fragments::surface
                                                 : Fragments::plain);
  set(program_, "has_matcap", has_matcap ? 1 : 0);
  if (has_matcap)
    bind_texture(Unit::matcap, GL_TEXTURE_2D,
                 matcaps_[static_cast<std::size_t>(style_.material) - 1]->texture());
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

void Renderer::draw_model(const render::Material& material) {
  if (!model_.is_there()) return;
  next_.is_model = true;
  draw_layers(material, [&] {
    if (program_ == programs_[static_cast<std::size_t>(Fragments::surface)])
      return model_.draw_coats(program_);
    if (!next_.flat) set(program_, "colour", model_.paint().coats().front().colour);
    model_.draw(is_coarse_here());
  });
  next_.is_model = false;
}

void Renderer::draw_surface(const render::Surface& surface) {
  if (surface.corners.empty()) return;
  const std::array<const std::vector<Vector3f>*, 2> vectors{&surface.places, &surface.normals};
  for (GLuint which = 0; which < 2; ++which) {
    fill_buffer(GL_ARRAY_BUFFER, stream_[which], *vectors[which], GL_STREAM_DRAW);
    glEnableVertexAttribArray(which);
    glVertexAttribPointer(which, 3, GL_FLOAT, GL_FALSE, 0, nullptr);
  }
  glDisableVertexAttribArray(2); // the model's colours
  fill_buffer(GL_ELEMENT_ARRAY_BUFFER, stream_[2], surface.corners, GL_STREAM_DRAW);
  draw_layers(surface.material, [&] {
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(surface.corners.size()), GL_UNSIGNED_INT,
                   nullptr);
  });
}

template <class Triangles>
void Renderer::draw_layers(const render::Material& material, const Triangles& triangles) {
  if (material.opacity >= 1.0F) {
    use_material(material);
    triangles();
    return;
  }
  // Depth first, so that only its nearest layer is mixed in.
  glStencilOp(GL_KEEP, GL_KEEP, GL_KEEP);
  glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
  use(Fragments::flat);
  triangles();
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  use_material(material);
  if (material.opaque_before_ground) {
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
void Renderer::for_each_program(const Sets& sets) {
  for (const Fragments fragments : all_fragments) {
    use(fragments);
    sets();
  }
}

// Makes the map of the key light's shadow. Returns false if nothing casts a shadow.
bool Renderer::cast_shadows(const render::Scene& beside, const Vector3f& key) {
  Eigen::AlignedBox3f box = model_.box();
  for (const auto* surfaces : {&beside.solids, &beside.veils})
    for (const render::Surface& surface : *surfaces)
      if (casts(surface))
        for (const Vector3f& place : surface.places)
          extend(box, place);
  bind_texture(Unit::shadows, GL_TEXTURE_2D, 0); // nothing may read what is being drawn
  if (!shadows_->begin(box, key)) return false;
  next_.flat = true;
  use(Fragments::flat);
  set(program_, "clip_of_world", shadows_->map_of_world());
  draw_closed(model_.is_closed(), [&] { draw_model(beside.model.material); });
  for (const render::Surface& solid : beside.solids)
    if (casts(solid)) draw_surface(solid);
  for (const render::Surface& skin : beside.veils)
    if (casts(skin)) draw_closed(true, [&] { draw_surface(skin); });
  shadows_->end();
  bind_texture(Unit::shadows, GL_TEXTURE_2D, shadows_->texture());
  return true;
}

void Renderer::set_style(const Style& style) {
  const bool is_same = style.outlined == style_.outlined && style.parts == style_.parts;
  style_ = style;
  if (is_same) return;
  outlined_.clear();
  if (!style.parts) return;
  const std::vector<std::uint32_t>& corners = model_.corners();
  for (std::size_t at = 0; at + 2 < corners.size(); at += 3) {
    const std::uint32_t part = style.parts->at_place(corners[at]);
    if (part != deform::no_index &&
        std::count(style.outlined.begin(), style.outlined.end(), part) > 0)
      outlined_.insert(outlined_.end(), &corners[at], &corners[at] + 3);
  }
}

/// Also clears the framebuffer.
void Renderer::begin_picture(const render::Camera& camera, render::Size size) {
  glEnable(GL_DEPTH_TEST);
  glDepthFunc(GL_LEQUAL);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SCISSOR_TEST);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glBindVertexArray(vertex_array_);
  glViewport(0, 0, size.width, size.height);
  glClearStencil(ground_mark);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT | GL_STENCIL_BUFFER_BIT);
  const Eigen::Matrix4f clip = camera.projection(1.0 * size.width / size.height).cast<float>();
  for_each_program([&] { set(program_, "clip_of_world", clip); });
}

bool Renderer::is_coarse_here() const noexcept {
  return model_.is_coarse() &&
         (next_.flat || style_.material != Material::lit || model_.has_one_coat());
}

// What faces away from the eye is hidden by a closed surface's other side.
template <class Draws>
void Renderer::draw_closed(bool is_closed, const Draws& draws) {
  if (next_.is_quick && is_closed) glEnable(GL_CULL_FACE);
  draws();
  glDisable(GL_CULL_FACE);
}

// What the hands or the camera move is drawn coarser, if its triangles are only a few pixels wide.
// It is chosen by the shape as it was when it rested.
void Renderer::choose_triangles(const render::Camera& camera, render::Size size) {
  constexpr double coarse_px = 6.0;
  if (!next_.is_quick || style_.facets || !model_.is_there()) return model_.refine();
  const double across_m = 2.0 * camera.tangent() * camera.distance_m; // of the picture's height
  const double longest_m = static_cast<double>(model_.box().sizes().maxCoeff());
  model_.coarsen(static_cast<int>(std::min(longest_m * size.height / across_m / coarse_px, 1e6)));
}

void Renderer::draw(const render::Scene& beside, const render::Camera& camera, render::Size size,
                    const Style& style, bool is_quick) {
  set_style(style);
  next_ = {};
  next_.is_quick = is_quick;
  choose_triangles(camera, size);
  shadows_ = is_quick ? &coarse_shadows_ : &fine_shadows_;
  glBindVertexArray(vertex_array_);
  const double azimuth_deg = camera.view.azimuth_deg;
  const Vector3f key = render::turned(render::key_direction, azimuth_deg);
  const bool shadowed = cast_shadows(beside, key);
  glClearColor(0.90F, 0.91F, 0.92F, 1.0F);
  begin_picture(camera, size);
  for_each_program([&] {
    set(program_, "map_of_world", shadows_->map_of_world());
    set(program_, "slack", shadows_->slack_m());
    set(program_, "is_quick", is_quick ? 1 : 0);
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
  next_.shadowed = shadowed;
  glStencilFunc(GL_ALWAYS, solid_mark, 0xFF);
  draw_closed(model_.is_closed(), [&] { draw_model(beside.model.material); });
  if (model_.is_there() && !outlined_.empty()) draw_outline(size);
  draw_parts(beside, shadowed);
  glDisable(GL_STENCIL_TEST);
}

void Renderer::draw_silhouette(const render::Scene& beside, const render::Camera& camera,
                               render::Size size) {
  glClearColor(0.0F, 0.0F, 0.0F, 1.0F);
  begin_picture(camera, size);
  next_ = {};
  next_.flat = true;
  draw_model(beside.model.material);
  for (const render::Surface& solid : beside.solids)
    draw_surface(solid);
  for (const render::Surface& veil : beside.veils)
    if (casts(veil)) draw_surface(veil);
}

// Marks where the triangles are seen, and draws them, larger by the line's width, beside the marks.
void Renderer::draw_outline(render::Size size) {
  use(Fragments::flat);
  set(program_, "colour", style_.accent);
  model_.bind_vertices();
  fill_buffer(GL_ELEMENT_ARRAY_BUFFER, stream_[2], outlined_, GL_STREAM_DRAW);
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
void Renderer::draw_parts(const render::Scene& beside, bool shadowed) {
  const auto receives = [&](bool yes) { next_.shadowed = yes && shadowed; };
  const auto mark = [](GLint as) { glStencilFunc(GL_ALWAYS, as, solid_mark); };
  receives(true);
  mark(ground_mark);
  for (const render::Surface& ground : beside.grounds)
    draw_surface(ground);
  mark(solid_mark);
  receives(false); // bones lie in the shadow of their skin
  for (const render::Surface& solid : beside.solids)
    draw_surface(solid);
  receives(true);
  mark(ground_mark);
  for (const render::Surface& veil : beside.veils)
    if (casts(veil)) draw_closed(true, [&] { draw_surface(veil); }); // a hand
  for (const render::Surface& veil : beside.veils)
    if (!casts(veil)) draw_surface(veil);
}

} // namespace nendo::gl
