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
#include "export/gltf_parts.hpp"
#include "export/morph_normals.hpp"

namespace nendo::exporting {

class GltfModel {
public:
  /// Puts the rest shape into `file`, in the parts that parts_of() returns. The mesh must have a
  /// vertex, and its vertices must fit in floats.
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

  std::size_t target_count() const noexcept { return names_.size(); }
  /// Returns the index of the model's node.
  GlbFile::Index node() const noexcept { return node_; }
  /// Adds node and mesh to the document. Call it once, after everything else.
  void add_to(GlbFile& file, const GltfMaterials& materials, double units_per_metre,
              const MorphReport& report) const;

private:
  /// `way` and `turn`: how far the target moves each vertex and its normal, 3 by #vertices.
  void add_target(const Eigen::Matrix3Xf& way, const Eigen::Matrix3Xf& turn, std::string name,
                  GlbFile& file);

  GlbFile::Index node_ = 0;
  std::vector<GltfPart> parts_;
  MorphNormals normals_;
  std::vector<GlbFile::Json> primitives_; ///< one for each part
  std::vector<GlbFile::Json> targets_;    ///< the lists of the parts' targets
  GlbFile::Json names_ = GlbFile::Json::array();
  std::vector<float> target_values_;                      ///< of functions
  Eigen::Matrix3Xf latest_;                               ///< of the targets
  std::vector<std::optional<std::uint32_t>> key_targets_; ///< nothing means the rest shape
};

} // namespace nendo::exporting
