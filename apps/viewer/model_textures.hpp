#pragma once
// The textures of a model on the graphics card, and the texture coordinates and colours of its
// triangles' corners. All calls belong to the thread that has the OpenGL context.

#include <array>
#include <cstdint>
#include <vector>

#include "render/paint.hpp"

namespace nendo::viewer {

class ModelTextures {
public:
  /// The units of the textures that the shaders read: corners, their texture coordinates, their
  /// colours, picture.
  static constexpr std::array<int, 4> units{4, 5, 6, 7};

  ModelTextures() = default;
  ~ModelTextures();
  ModelTextures(const ModelTextures&) = delete;
  ModelTextures& operator=(const ModelTextures&) = delete;

  /// Sets the paint of another model. `corners` are the vertices' places in the blocks, three for
  /// each triangle. A picture that is too large for the card is left out.
  void set(const render::Paint& paint, const std::vector<std::uint32_t>& corners);
  /// Prepares the program, which must be in use, for the next calls of use().
  void bind(unsigned program) const;
  /// Makes the coat's picture the one that is drawn. Returns false if it has none.
  bool use(std::size_t coat) const;

private:
  void remove();

  std::array<unsigned, 3> buffers_{};
  std::array<unsigned, 3> buffer_textures_{}; ///< 0 where corners have nothing of their own
  std::vector<unsigned> pictures_;            ///< one for each coat; 0: none
};

} // namespace nendo::viewer
