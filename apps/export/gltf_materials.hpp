#pragma once
// Puts a model's materials, and the textures of their base colours, into a glTF document.

#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "export/glb_file.hpp"

namespace nendo::exporting {

/// Returns the one with the most materials. Versions of a model add theirs behind those before.
const deform::Appearance& richest_of(std::span<const deform::Appearance* const> looks) noexcept;

class GltfMaterials {
public:
  /// Adds all materials of `look` to `file`, and one of clay for faces that have none. Textures
  /// that are neither PNG nor JPEG are left out, for glTF has no others.
  GltfMaterials(const deform::Appearance& look, GlbFile& file);

  /// Returns the index in the file of a material of the look; of deform::no_index, that of clay.
  GlbFile::Index index_of(std::uint32_t material) const noexcept {
    return material == deform::no_index ? plain_ : indices_[material];
  }

private:
  GlbFile::Index plain_ = 0; ///< material of faces without one
  std::vector<GlbFile::Index> indices_;
};

} // namespace nendo::exporting
