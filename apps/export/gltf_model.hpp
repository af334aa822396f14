#pragma once
// Puts the model into a glTF document: its rest shape, and morph targets of each kind.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "export/control_morphs.hpp"
#include "export/exported.hpp"
#include "export/function_morphs.hpp"
#include "export/glb_file.hpp"
#include "export/gltf_materials.hpp"

namespace nendo::exporting {

class GltfModel {
public:
  /// Puts the rest shape into `file`, with a primitive for each material. The mesh must have a
  /// vertex, and its vertices must fit in floats. A vertex with several texture coordinates is put
  /// behind all others once more for each further one, for glTF has one for each vertex.
  GltfModel(const deform::Mesh& mesh, GlbFile& file);

  /// Adds two targets for each axis of each influence that reaches a vertex: one along the axis and
  /// one against it, because Blender and other programs do not accept negative weights. Returns the
  /// weights of all targets, moment by moment, from 0 to 1.
  std::vector<float> add_control_targets(const ControlMorphs& morphs, GlbFile& file);

  /// Adds the targets of all functions, which have their names. In the mesh's extras,
  /// "targetValues" are the values of the functions at weights of 1.
  void add_function_targets(const FunctionMorphs& morphs, GlbFile& file);

  /// Adds the next key's shape, as displacements from the rest shape (3 by #vertices). A shape that
  /// equals the latest one, or the rest shape, does not get a target of its own.
  void add_key_target(const Eigen::Matrix3Xf& way, GlbFile& file);
  /// Returns the number of weights of all keys so far. Each key has one weight for each target.
  std::uint64_t key_weight_count() const noexcept {
    return std::uint64_t{key_targets_.size()} * target_count();
  }
  /// Adds the weights of all keys, which must be fewer than 2^32. The weight of a key's own target
  /// is 1, all others are 0.
  GlbFile::Index add_key_weights(GlbFile& file) const;

  std::size_t target_count() const noexcept { return targets_.size(); }
  /// Returns the index of the model's node.
  GlbFile::Index node() const noexcept { return node_; }
  /// Adds node and mesh to the document. Call it once, after everything else.
  void add_to(GlbFile& file, const GltfMaterials& materials, double units_per_metre,
              const MorphReport& report) const;

private:
  struct Primitive {
    std::uint32_t material; ///< of the look
    GlbFile::Json json;
  };
  std::vector<std::uint32_t> split_at_seams(const deform::Mesh& mesh,
                                            std::vector<float>& texcoords);
  Eigen::Matrix3Xf with_copies(const Eigen::Matrix3Xf& of_vertices) const;
  void add_primitives(const deform::Mesh& mesh, const std::vector<std::uint32_t>& corner_vertices,
                      const GlbFile::Json& attributes, GlbFile& file);
  void add_target(const Eigen::Matrix3Xf& way, std::string name, GlbFile& file);

  GlbFile::Index node_ = 0;
  std::vector<Primitive> primitives_;
  std::vector<std::uint32_t> copies_; ///< of each vertex behind the mesh's, which one it is
  GlbFile::Json targets_ = GlbFile::Json::array();
  GlbFile::Json names_ = GlbFile::Json::array();
  std::vector<float> target_values_;                      ///< of functions
  Eigen::Matrix3Xf latest_;                               ///< of the targets
  std::vector<std::optional<std::uint32_t>> key_targets_; ///< nothing means the rest shape
};

} // namespace nendo::exporting
