#pragma once
// The nodes of a glTF scene: which meshes there are, and where.

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <Eigen/Geometry>

#include "files/gltf_document.hpp"

namespace nendo::deform {

/// A mesh in its place.
struct GltfPlacedMesh {
  std::uint64_t mesh = 0;
  std::string name; ///< the node's
  Eigen::Affine3d T_world_node = Eigen::Affine3d::Identity();
  /// Of a skinned mesh, what moves the vertices of each joint; its own node has no effect then
  /// (glTF 2.0, 3.7.3.3).
  std::shared_ptr<const std::vector<Eigen::Affine3d>> joints;
  std::vector<double> weights; ///< of morph targets; empty: all are 0

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

} // namespace nendo::deform
