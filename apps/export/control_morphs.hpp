#pragma once
// Exports a take of Type-1 exactly, as morph targets. As long as the fingertips keep hold, the
// start points are frozen, and the rest shape is displaced by sum_j u_j(x) w_j, with an influence
// u_j for each start point and its control vector w_j (nendo/deform/field.hpp). The displacement is
// linear in the vectors, so it is given by targets along the axes for each vector and by their
// weights over time.
//
// With one radius, u_j is 1 at its start point and 0 at the others. With several radii there are
// more functions than start points, and each function has its own targets instead.

#include <optional>
#include <vector>

#include <nendo/flow/frame.hpp>

namespace nendo::exporting {

class ControlMorphs {
public:
  /// A shape that differs by more than this fraction of the model's diagonal is not linear in the
  /// control vectors. Type-1 keeps its own shapes within the same bound.
  static constexpr double max_error = 1e-5;

  /// weights: how far each vertex follows, which stays linear (deform::VertexMask); empty: all do.
  explicit ControlMorphs(const deform::BlockLayout& layout, Eigen::VectorXd weights = {});

  /// Adds a frame with its vertices, in the mesh's order. Returns false if the take is not linear
  /// (commits, several links, polynomials, Type-2). The frames before remain, and no other may be
  /// added then.
  bool add(const flow::Frame& frame, const deform::Points& vertices);

  /// Returns the greatest error of the frames so far, in model units. It is measured in 32-bit
  /// floats, as a reader of the targets computes them.
  double greatest_error() const noexcept { return greatest_error_; }
  /// Returns how far each vertex is from the model at rest, in the frame with that number from 0:
  /// 3 by #vertices.
  Eigen::Matrix3Xf displacement(std::size_t frame) const;
  /// Returns one row for each control vector and one column for each vertex. The influence is zero
  /// where no support reaches.
  const Eigen::MatrixXf& influences() const noexcept { return influences_; }
  /// Returns the largest absolute coordinate of all control vectors. It is 0 if nothing ever moved.
  float greatest_vector() const noexcept;
  /// Returns the control vectors of each frame, one after another: x y z of the first, and so on.
  std::vector<float> vectors() const;

private:
  bool set_basis(const deform::CsrbfField& field);
  Eigen::Matrix3Xf vectors_of(const deform::CsrbfField& field) const;

  const deform::BlockLayout& layout_;
  Eigen::VectorXd weights_;
  Eigen::Matrix3Xf rest_;
  deform::Points centres_; ///< of the basis; empty until a frame has a field
  bool cardinal_ = false;  ///< otherwise the functions themselves are the basis
  Eigen::MatrixXf influences_;
  std::size_t still_ = 0;      ///< frames before the basis was known
  std::vector<float> vectors_; ///< of the later frames
  double greatest_error_ = 0.0;
};

} // namespace nendo::exporting
