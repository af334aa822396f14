#pragma once
// Draws a scene with OpenGL 3.3. Uploads only blocks of the model with changed stamps. All calls:
// the thread with the OpenGL context.

#include <array>
#include <memory>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/base/result.hpp>

#include "render/camera.hpp"
#include "render/image.hpp"
#include "render/scene.hpp"
#include "viewer/gl_objects.hpp"

namespace nendo::viewer {

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

  /// Smooth shading, flat shading, or white on black.
  enum class Look { shaded, facets, silhouette };
  /// Draws the model, and everything of `beside` except its model, into the bound framebuffer,
  /// after clearing it. The model and the hands cast shadows.
  void draw(const render::Scene& beside, const render::Camera& camera, render::Size size,
            Look look = Look::shaded);

private:
  GlRenderer() = default;
  void send_surface(const render::Surface& surface);
  void draw_surface(const render::Surface& surface, bool model);
  void draw_parts(const render::Scene& beside, Look look, bool shadowed);
  bool cast_shadows(const render::Scene& beside, const Eigen::Vector3f& key);
  void use(Fragments fragments);
  template <class Sets>
  void for_each_program(const Sets& sets);
  void use_material(const render::Material& material);
  void use_model();
  void draw_model() const;

  std::array<unsigned, 3> programs_{}; ///< index: Fragments
  unsigned program_ = 0;               ///< the program in use
  struct {
    bool white = false, facets = false, shadowed = false;
  } next_; ///< the state for the next surfaces
  unsigned vertex_array_ = 0;
  unsigned model_indices_ = 0;
  std::array<unsigned, 3> model_buffers_{};  ///< positions, normals and colours, in blocks
  std::array<unsigned, 3> model_textures_{}; ///< through which the shader reads model_buffers_
  std::array<unsigned, 3> stream_{};   ///< positions, normals and corners of the other surfaces
  std::vector<std::uint32_t> corners_; ///< indices into the blocks
  std::shared_ptr<const render::Paint> paint_;
  deform::BlockShape shape_; ///< the uploaded shape
  std::vector<Eigen::Vector3f> places_, normals_, new_normals_;
  std::vector<float> block_;
  Eigen::AlignedBox3f box_; ///< the model's box in the scene
  ModelTextures textures_;
  ShadowMap shadows_;
  Eigen::Vector3f offset_ = Eigen::Vector3f::Zero();
  float scale_ = 1.0F;
  bool whole_ = false; ///< the whole model is uploaded
  std::uint64_t blocks_sent_ = 0;
};

} // namespace nendo::viewer
