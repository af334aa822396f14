#pragma once
// Puts the model into a glTF document: its rest shape, and morph targets of each kind.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <nendo/deform/mesh.hpp>

#include "export/chosen_frames.hpp"
#include "export/glb_file.hpp"
#include "export/morphs.hpp"

namespace nendo::exporting {

/// Returns the one with the most materials. Versions of a model add theirs behind those before.
const deform::Appearance& richest_of(std::span<const deform::Appearance* const> looks) noexcept;

/// Puts a model's materials, and the textures of their base colours, into a glTF document.
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

/// The faces of one material, which are a primitive. glTF has one texture coordinate for each
/// vertex, so vertices are split where several meet. Readers copy all vertices that a primitive
/// names, so primitives do not share vertices. The three lists of vertices have the same length.
struct GltfPart {
  std::uint32_t material = deform::no_index; ///< an index of the look's materials, or no_index
  std::vector<std::uint32_t> vertices;       ///< vertex indices of the mesh
  std::vector<std::uint32_t> texcoords;      ///< one per vertex, or no_index
  std::vector<std::uint32_t> triangles;      ///< three indices into `vertices` for each triangle
};

/// Returns the parts in the order of their materials; faces without a material come last. The
/// vertices of a part are in the order of the mesh, and then the copies. A vertex without a face
/// belongs to the first part. There is at least one part; it has no triangles if the mesh has none.
std::vector<GltfPart> parts_of(const deform::Mesh& mesh);

/// The normals of morph targets.
/// A viewer adds the weighted normals of the targets to the normal at
/// rest, and makes the sum a unit vector (glTF 2.0, 3.7.2.2). A vertex's normal has the direction
/// of the sum of its faces' areas, which is a polynomial of degree two in the displacement. So sums
/// of areas, divided by the area at rest, come much closer to the normal of a mixed shape than
/// differences of unit vectors do.
class MorphNormals {
public:
  /// Copies what it needs of the mesh.
  explicit MorphNormals(const deform::Mesh& mesh);

  /// Returns the unit normals at rest, 3 by #vertices.
  Eigen::Matrix3Xf rest() const;
  /// Returns what must be added to them so that the sum has the direction of the normal of the
  /// displaced shape. `way` is the displacement, 3 by #vertices. For a target that is alone.
  Eigen::Matrix3Xf turn_to(const Eigen::Matrix3Xf& way) const;
  /// Returns the part of this that is linear in the displacement. For targets that are mixed with
  /// small weights.
  Eigen::Matrix3Xf turn_along(const Eigen::Matrix3Xf& way) const;

private:
  deform::Points areas(double way_factor, const Eigen::Matrix3Xf& way) const;
  Eigen::Matrix3Xf divided(const deform::Points& turn) const;

  deform::Mesh shape_; ///< vertices and faces alone
  double unit_ = 1.0;  ///< unit of length: the model's diagonal
  deform::Points rest_areas_;
  Eigen::VectorXd lengths_; ///< the areas at rest; 0 where a vertex has no area
};

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
  std::vector<float> target_values_;                      ///< values of functions
  Eigen::Matrix3Xf latest_;                               ///< the latest target
  std::vector<std::optional<std::uint32_t>> key_targets_; ///< nothing means the rest shape
};

} // namespace nendo::exporting
