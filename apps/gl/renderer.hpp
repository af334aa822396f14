#pragma once
// Draws a scene with OpenGL 3.3. All calls: the thread with the OpenGL context.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>
#include <nendo/deform/part_mover.hpp>

#include "gl/matcap.hpp"
#include "gl/model.hpp"
#include "gl/picture.hpp"
#include "gl/shaders.hpp"
#include "gl/shadow_map.hpp"
#include "render/camera.hpp"
#include "render/image.hpp"
#include "render/scene.hpp"

namespace nendo::gl {

/// How a scene is drawn.
struct Style {
  bool facets = false; ///< flat instead of smooth shading
  Material material = Material::lit;
  /// Spheres in metres of the scene: centre and radius, at most max_reaches. The model has a line
  /// where their union meets it.
  std::vector<Eigen::Vector4f> reaches{};
  /// The numbers of the model's parts that get an outline; no_index: none.
  std::array<std::uint32_t, 2> outlined{deform::no_index, deform::no_index};
  std::shared_ptr<const deform::ModelParts> parts{};
  Eigen::Vector3f accent = Eigen::Vector3f::Zero(); ///< the colour of lines, sRGB, 0 to 1
  float line_width_px = 2.0F;

  static constexpr std::size_t max_reaches = 10;
  bool operator==(const Style&) const = default;
};

class Renderer {
public:
  /// Needs a current context. Error: failed (no OpenGL 3.3; the message has the available version).
  static Result<std::unique_ptr<Renderer>> make();
  ~Renderer();
  Renderer(const Renderer&) = delete;
  Renderer& operator=(const Renderer&) = delete;

  void set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder);
  /// The model of set_model(). Call its follow() before draw().
  Model& model() noexcept { return model_; }
  const Model& model() const noexcept { return model_; }

  /// Draws the model, and everything of `beside` except its model, into the bound framebuffer,
  /// after clearing it. The model and the hands cast shadows. With `is_quick`, for software
  /// rendering, triangles of about a pixel are merged, and those that face away are left out.
  void draw(const render::Scene& beside, const render::Camera& camera, render::Size size,
            const Style& style, bool is_quick);
  /// Does the same in white on black, without shadows and lines.
  void draw_silhouette(const render::Scene& beside, const render::Camera& camera,
                       render::Size size);

private:
  Renderer() = default;
  void set_style(const Style& style);
  void begin_picture(const render::Camera& camera, render::Size size);
  void draw_parts(const render::Scene& beside, bool shadowed);
  void draw_outline(render::Size size);
  bool cast_shadows(const render::Scene& beside, const Eigen::Vector3f& key);
  void use(Fragments fragments);
  template <class Sets>
  void for_each_program(const Sets& sets);
  void use_material(const render::Material& material);
  void draw_model(const render::Material& material);
  void draw_surface(const render::Surface& surface);
  template <class Triangles>
  void draw_layers(const render::Material& material, const Triangles& triangles);
  template <class Draws>
  void draw_closed(bool is_closed, const Draws& draws);
  void choose_triangles(const render::Camera& camera, render::Size size);
  bool is_coarse_here() const noexcept;

  Model model_;
  std::array<unsigned, fragments_count> programs_{}; ///< index: Fragments
  unsigned program_ = 0;                             ///< the program in use
  struct {
    bool flat = false, is_model = false, shadowed = false, is_quick = false;
  } next_;                              ///< the state for the next surfaces
  Style style_;                         ///< the style of the current picture
  std::vector<std::uint32_t> outlined_; ///< corners of the outlined triangles
  unsigned vertex_array_ = 0;
  std::array<unsigned, 3> stream_{}; ///< positions, normals and corners of the other surfaces
  std::vector<std::unique_ptr<const Picture>> matcaps_; ///< the pictures of materials after lit
  ShadowMap fine_shadows_{2048}, coarse_shadows_{1024};
  ShadowMap* shadows_ = &fine_shadows_; ///< the map of the current picture
};

} // namespace nendo::gl
