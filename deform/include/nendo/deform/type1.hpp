#pragma once
// Type-1 (the paper, 2.4): the start points are frozen when the operator grabs. Every tick only the
// end points move, so the factor is kept and the rest shape is deformed anew: nothing accumulates.

#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

class Type1Deformer {
public:
  /// rest: 3 by #vertices. radius > 0 in model units. Allocates for `control_points` start points.
  Type1Deformer(Points rest, Eigen::Index control_points, double radius, CsrbfOptions options);

  /// Freezes the start points (3 by control_points). Not on failure: the last good grab stays. No
  /// allocation.
  FieldStatus grab(const Points& starts);
  /// Deforms the rest shape so that the start points go to `ends`, into `out`. On failure `out` is
  /// the last good shape's field applied again; before the first grab, singular and the rest shape.
  /// No allocation if `out` has the size of the rest shape.
  FieldStatus apply(const Points& ends, Points& out);
  /// The shape that apply() last gave becomes the rest shape, and `ends` the new start points.
  FieldStatus commit(const Points& ends);

  const Points& rest() const noexcept { return rest_; }
  const CsrbfField& field() const noexcept { return field_; }

private:
  Points rest_;
  Points starts_;
  Points displacements_;
  Eigen::VectorXd radii_;
  CsrbfSolver solver_;
  CsrbfField field_;
  bool grabbed_ = false;
};

} // namespace nendo::deform
