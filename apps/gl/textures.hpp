#pragma once
// The textures of a model. All calls: the thread with the OpenGL context.

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "gl/picture.hpp"
#include "render/paint.hpp"

namespace nendo::gl {

/// The textures of a model, and the texture coordinates and colours of its triangles' corners.
class ModelTextures {
public:
  ModelTextures() = default;
  ~ModelTextures();
  ModelTextures(const ModelTextures&) = delete;
  ModelTextures& operator=(const ModelTextures&) = delete;

  /// Sets the paint of a model. `corners` are indices of vertices, three per triangle, and
  /// `colours` those of vertices. Omits pictures that are too large for the GPU.
  void set(const render::Paint& paint, const std::vector<std::uint32_t>& corners,
           const std::vector<Eigen::Vector3f>& colours);
  /// Selects the corners' data for drawing.
  void bind() const;
  /// Selects the coat's picture for drawing. Returns false if it has none.
  bool use(std::size_t coat) const;

private:
  void remove();

  std::array<unsigned, 3> buffers_{};
  std::array<unsigned, 3> buffer_textures_{}; ///< 0: no such data per corner
  std::vector<std::shared_ptr<const Picture>>
      pictures_; ///< one per coat, or null; coats may share one
};

} // namespace nendo::gl
