#pragma once
// The normals of morph targets. A viewer adds the weighted normals of the targets to the normal at
// rest, and makes the sum a unit vector (glTF 2.0, 3.7.2.2). A vertex's normal has the direction of
// the sum of its faces' areas, which is a polynomial of degree two in the displacement. So sums of
// areas, divided by the area at rest, come much closer to the normal of a mixed shape than
// differences of unit vectors do.

#include <nendo/deform/mesh.hpp>

namespace nendo::exporting {

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
  double unit_ = 1.0;  ///< of length: the model's diagonal
  deform::Points rest_areas_;
  Eigen::VectorXd lengths_; ///< the areas at rest; 0 where a vertex has no area
};

} // namespace nendo::exporting
