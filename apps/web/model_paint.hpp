#pragma once
// The triangles of the model message, and their colours.

#include <array>
#include <cstdint>
#include <vector>

#include <nendo/deform/mesh.hpp>
#include <nendo/deform/vertex_blocks.hpp>

#include "web/wire.hpp"

namespace nendo::web {

struct ModelPaint {
  /// Of the triangles that are drawn, the vertices' places in the blocks.
  std::vector<std::uint32_t> corners;
  std::vector<CoatHead> coats; ///< of the triangles, in their order
  /// Of each corner; empty if no coat has a texture.
  std::vector<std::array<float, 2>> texcoords;
  /// Linear, red, green, blue of each vertex in block order, or of each corner, 65535 for 1; empty
  /// if all are white.
  std::vector<std::array<std::uint16_t, 3>> colours;
  bool colours_of_corners = false;
};

/// Returns what deform::drawn_faces() tells of the mesh. `layout` must be the mesh's. Allocates.
ModelPaint paint_of(const deform::Mesh& mesh, const deform::BlockLayout& layout);

} // namespace nendo::web
