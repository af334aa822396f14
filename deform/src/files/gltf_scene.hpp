#pragma once
// What a glTF scene shows: its meshes in their places, their morph targets, and its materials.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include <nendo/deform/material.hpp>
#include <nendo/deform/read_notes.hpp>

#include "files/gltf_document.hpp"

namespace nendo::deform {

/// A mesh in its place.
struct GltfPlacedMesh {
  std::uint64_t mesh = 0;
  std::string name; ///< the node's
  Eigen::Affine3d T_world_node = Eigen::Affine3d::Identity();
  /// What moves the vertices of each joint, if the mesh is skinned; its own node has no effect
  /// then (glTF 2.0, 3.7.3.3).
  std::shared_ptr<const std::vector<Eigen::Affine3d>> joints;
  std::vector<double> weights; ///< the morph targets'; empty: all are 0

  /// Returns whether the node turns faces inside out.
  bool mirrors() const noexcept;
  /// Returns the vertices in the scene. `attributes` are the primitive's. Throws GltfRefusal.
  std::vector<Eigen::Vector3d> moved(const GltfDocument& document,
                                     const GltfDocument::Json& attributes,
                                     const GltfNumbers& places) const;
};

/// Returns the meshes of the default scene, or of all nodes if there are no scenes, depth first. A
/// node with instances (EXT_mesh_gpu_instancing) has its mesh in the place of each.
/// Throws GltfRefusal.
std::vector<GltfPlacedMesh> placed_meshes(const GltfDocument& document);

/// Moves the vertices of a primitive by its morph targets (glTF 2.0, 3.7.2.2) at these weights.
/// Returns the number of the targets' vertices that it read. Throws GltfRefusal.
std::size_t apply_targets(const GltfDocument& document, const GltfDocument::Json& primitive,
                          const std::vector<double>& weights, GltfNumbers& places);

/// How a material uses texture coordinates.
struct GltfMaterial {
  std::uint32_t texcoord_set = 0;                                  ///< TEXCOORD_n
  Eigen::Affine2d texture_transform = Eigen::Affine2d::Identity(); ///< KHR_texture_transform
};

/// Adds all materials of the document to `look`, in their order, and the textures that they use.
/// Notes textures that are missing. Throws GltfRefusal.
std::vector<GltfMaterial> read_gltf_materials(const GltfDocument& document, Appearance& look,
                                              NoteSum& notes);

} // namespace nendo::deform
