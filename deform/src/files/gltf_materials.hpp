#pragma once
// Materials of glTF: base colours and their textures.

#include <cstdint>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/material.hpp>
#include <nendo/deform/read_notes.hpp>

#include "files/gltf_document.hpp"

namespace nendo::deform {

/// What of a material concerns a primitive's texture coordinates.
struct GltfMaterial {
  std::uint32_t texcoord_set = 0;                                  ///< TEXCOORD_n
  Eigen::Affine2d texture_transform = Eigen::Affine2d::Identity(); ///< KHR_texture_transform
};

/// Adds all materials of the document to `look`, in their order, and the textures that they use.
/// Notes textures that are missing. Throws GltfRefusal.
std::vector<GltfMaterial> read_gltf_materials(const GltfDocument& document, Appearance& look,
                                              NoteSum& notes);

} // namespace nendo::deform
