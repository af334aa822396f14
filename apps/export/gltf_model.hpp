#pragma once
// The model in a glTF document: its rest shape, and morph targets of either kind.

#include <cstdint>
#include <optional>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "export/control_morphs.hpp"
#include "export/exported.hpp"
#include "export/glb_file.hpp"

namespace nendo::exporting {

class GltfModel {
public:
  static constexpr GlbFile::Index node = 0; ///< where the model's node stands: it is the first

  /// Puts the rest shape into `file`. The mesh has a vertex, and its vertices fit in floats.
  GltfModel(const deform::Mesh& mesh, GlbFile& file);

  /// Targets for each influence that reaches a vertex: along each axis, and against it, because
  /// Blender and others take no weight below 0. That stays linear: on a way from one side to the
  /// other, one weight falls to 0 as the other rises from it. Gives the weights of all of them,
  /// moment by moment, 0 to 1.
  std::vector<float> add_control_targets(const ControlMorphs& morphs, GlbFile& file);

  /// The next key's shape, as displacements from the rest shape (3 by #vertices). One like the
  /// latest, or like the rest shape, needs no target of its own.
  void add_key_target(const Eigen::Matrix3Xf& way, GlbFile& file);
  /// Of all keys so far, each with one for every target.
  std::uint64_t key_weight_count() const noexcept {
    return std::uint64_t{key_targets_.size()} * target_count();
  }
  /// The weights of all keys: each is its own target alone. Fewer than 2^32.
  GlbFile::Index add_key_weights(GlbFile& file) const;

  std::size_t target_count() const noexcept { return targets_.size(); }
  /// Node, mesh and material; once, as the last.
  void add_to(GlbFile& file, double units_per_metre, const MorphReport& report) const;

private:
  void add_target(const Eigen::Matrix3Xf& way, std::string name, GlbFile& file);

  GlbFile::Json primitive_;
  GlbFile::Json targets_ = GlbFile::Json::array();
  GlbFile::Json names_ = GlbFile::Json::array();
  Eigen::Matrix3Xf latest_;                               ///< of the targets
  std::vector<std::optional<std::uint32_t>> key_targets_; ///< nothing: the rest shape
};

} // namespace nendo::exporting
