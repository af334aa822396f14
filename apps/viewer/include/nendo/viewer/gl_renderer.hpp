#pragma once
// The same scene in OpenGL 3.3. Of the model, only blocks whose stamps changed go to the graphics
// card. All of this on the thread whose context it is.

#include <array>
#include <memory>
#include <vector>

#include <nendo/base/result.hpp>
#include <nendo/viewer/camera.hpp>
#include <nendo/viewer/image.hpp>
#include <nendo/viewer/scene.hpp>

namespace nendo::viewer {

class GlRenderer {
public:
  /// Needs a current context. Error: failed (no OpenGL 3.3, with what there is instead).
  static Result<std::unique_ptr<GlRenderer>> make();
  ~GlRenderer();
  GlRenderer(const GlRenderer&) = delete;
  GlRenderer& operator=(const GlRenderer&) = delete;

  /// Another model: its faces, and what its blocks mean. To be followed before it is drawn.
  void set_model(const deform::BlockLayout& layout, const SceneBuilder& builder);
  /// Brings the model up to date: blocks that changed, and normals that changed with them.
  void follow(const deform::BlockShape& shape);
  /// How many blocks follow() has sent since set_model().
  std::uint64_t blocks_sent() const noexcept { return blocks_sent_; }

  enum class Look { shaded, silhouette };
  /// The model, and of `beside` everything but its model, into the bound frame buffer, `below`
  /// pixels from its bottom; all of the buffer is cleared.
  void draw(const Scene& beside, const Camera& camera, Size size, Look look = Look::shaded,
            int below = 0);

private:
  GlRenderer() = default;
  void send_surface(const Surface& surface);
  void draw_surface(const Surface& surface, bool model);
  void use_material(const Material& material) const;

  unsigned program_ = 0;
  unsigned vertex_array_ = 0;
  unsigned model_indices_ = 0;
  std::array<unsigned, 2> model_buffers_{};  ///< places and normals, as blocks
  std::array<unsigned, 2> model_textures_{}; ///< through which the shader reads them
  std::array<unsigned, 3> stream_{};         ///< places, normals, corners of other surfaces
  std::vector<std::uint32_t> corners_;       ///< into blocks
  deform::BlockShape shape_;                 ///< as the card has it
  std::vector<Eigen::Vector3f> places_, normals_, new_normals_;
  std::vector<float> block_;
  Eigen::Vector3f offset_ = Eigen::Vector3f::Zero();
  float scale_ = 1.0F;
  bool whole_ = false; ///< the card has the model
  std::uint64_t blocks_sent_ = 0;
};

} // namespace nendo::viewer
