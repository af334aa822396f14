#pragma once
// Draws a scene with OpenGL 3.3. Uploads only blocks of the model with changed stamps. All calls:
// the thread with the OpenGL context.

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>
#include <nendo/deform/part_mover.hpp>

#include "render/camera.hpp"
#include "render/image.hpp"
#include "render/scene.hpp"
#include "viewer/gl_objects.hpp"
#include "viewer/matcap.hpp"

namespace nendo::viewer {

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

class GlRenderer {
public:
  /// Needs a current context. Error: failed (no OpenGL 3.3; the message has the available version).
  static Result<std::unique_ptr<GlRenderer>> make();
  ~GlRenderer();
  GlRenderer(const GlRenderer&) = delete;
  GlRenderer& operator=(const GlRenderer&) = delete;

  /// Sets a model: its faces and the layout of its blocks. Call follow() before draw().
  void set_model(const deform::BlockLayout& layout, const render::SceneBuilder& builder);
  /// Draws no model until set_model() and follow().
  void clear_model() noexcept { whole_ = false, box_.setEmpty(); }
  /// Uploads the blocks that changed since the last call, and the affected normals.
  void follow(const deform::BlockShape& shape);
  /// Returns the number of blocks that follow() has uploaded since set_model().
  std::uint64_t blocks_sent() const noexcept { return blocks_sent_; }

  /// Returns the model's box at the last follow(), in metres of the scene; empty before.
  const Eigen::AlignedBox3f& model_box() const noexcept { return box_; }

  /// Draws the model, and everything of `beside` except its model, into the bound framebuffer,
  /// after clearing it. The model and the hands cast shadows. With `is_quick`, for software
  /// rendering, triangles of about a pixel are merged, and those that face away are left out.
  void draw(const render::Scene& beside, const render::Camera& camera, render::Size size,
            const Style& style, bool is_quick);
  /// Does the same in white on black, without shadows and lines.
  void draw_silhouette(const render::Scene& beside, const render::Camera& camera,
                       render::Size size);

private:
  GlRenderer() = default;
  void send_surface(const render::Surface& surface);
  void draw_surface(const render::Surface& surface, bool model);
  void set_style(const Style& style);
  void begin_picture();
  void set_view(const render::Camera& camera, render::Size size);
  void draw_parts(const render::Scene& beside, bool shadowed);
  void draw_outline(render::Size size);
  bool cast_shadows(const render::Scene& beside, const Eigen::Vector3f& key);
  void use(Fragments fragments);
  template <class Sets>
  void for_each_program(const Sets& sets);
  void use_material(const render::Material& material);
  void use_model();
  void draw_model() const;
  void draw_closed(const render::Surface& surface, bool model);
  void coarsen(const render::Camera& camera, render::Size size);
  bool has_one_coat() const noexcept;
  bool is_coarse_here() const noexcept;
  bool is_merged() const noexcept;

  std::array<unsigned, fragments_count> programs_{}; ///< index: Fragments
  unsigned program_ = 0;                             ///< the program in use
  struct {
    bool flat = false, is_model = false, shadowed = false, is_quick = false;
  } next_;                              ///< the state for the next surfaces
  Style style_;                         ///< the style of the current picture
  std::vector<std::uint32_t> outlined_; ///< corners of the outlined triangles
  unsigned vertex_array_ = 0;
  unsigned model_indices_ = 0;
  unsigned coarse_indices_ = 0;             ///< the triangles of quick pictures
  std::size_t coarse_count_ = 0;            ///< their corners; 0: quick pictures have all triangles
  int coarse_cubes_ = 0;                    ///< the grid by which they were chosen; 0: none yet
  std::optional<bool> is_closed_;           ///< nothing behind the model's surface can be seen
  std::array<unsigned, 3> model_buffers_{}; ///< positions, normals and colours, in blocks
  std::array<unsigned, 3> model_textures_{}; ///< through which the shader reads model_buffers_
  std::array<unsigned, 3> stream_{};   ///< positions, normals and corners of the other surfaces
  std::vector<std::uint32_t> corners_; ///< indices into the blocks
  std::shared_ptr<const render::Paint> paint_;
  deform::BlockShape shape_; ///< the uploaded shape
  std::vector<Eigen::Vector3f> places_, normals_, new_normals_;
  std::vector<float> block_;
  Eigen::AlignedBox3f box_; ///< the model's box in the scene
  ModelTextures textures_;
  MatCapTextures matcaps_;
  ShadowMap fine_shadows_{2048}, coarse_shadows_{1024};
  ShadowMap* shadows_ = &fine_shadows_; ///< the map of the current picture
  Eigen::Vector3f offset_ = Eigen::Vector3f::Zero();
  float scale_ = 1.0F;
  bool whole_ = false; ///< the whole model is uploaded
  std::uint64_t blocks_sent_ = 0;
};

} // namespace nendo::viewer
