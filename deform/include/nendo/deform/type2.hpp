#pragma once
// Type-2 (the paper, 2.4): start and end points are neighbouring samples of each fingertip's curve.
// The curve is cut at a constant arc length; each piece deforms the current shape, which becomes
// the start of the next.

#include <nendo/deform/block_evaluator.hpp>
#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

struct StrokeResult {
  FieldStatus status = FieldStatus::ok;
  int pieces = 0; ///< how many pieces were cut and applied
};

/// The shape is in blocks, in float, and within 1e-5 of the model's diagonal of what displace()
/// makes in double of the same piece.
class Type2Deformer {
public:
  /// shape: 3 by #vertices. radius > 0 and piece_length > 0 in model units.
  Type2Deformer(Points shape, Eigen::Index control_points, double radius, double piece_length,
                CsrbfOptions options, const EvaluationOptions& evaluation = {});

  /// Starts a curve at these fingertips (3 by control_points) without deforming anything.
  void begin(const Points& tips);
  /// Extends the curves to `tips`, straight from the last cut: trembling by less than a piece
  /// deforms nothing. The fingertip that travels farthest sets the cuts; what is left, less than
  /// one piece, waits for the next call. A jump longer than `most_pieces` pieces is cut into that
  /// many equal ones, so that the time of a call is bounded. No allocation. A piece without a
  /// usable field is skipped; fingertips that are not finite are ignored, as not_finite.
  StrokeResult stroke_to(const Points& tips);
  /// Applies what is left of the stroke.
  StrokeResult finish();

  const BlockLayout& layout() const noexcept { return layout_; }
  /// A copy is brought up to date by BlockShape::follow().
  const BlockShape& shape() const noexcept { return shape_.shape; }
  /// The field of the piece applied last. Its centres are the fingertips as float holds them
  /// (BlockLayout::rounded).
  const CsrbfField& field() const noexcept { return field_; }

  static constexpr int most_pieces = 16;

private:
  StrokeResult advance_to_target(int pieces);
  StrokeResult advance(int pieces);
  FieldStatus apply_piece();

  BlockLayout layout_;
  BoundedShape shape_;
  Points current_; ///< where the curves have been cut last
  Points target_;  ///< where the fingertips are
  Points step_;
  Points rounded_; ///< current_, as float holds it
  Eigen::VectorXd radii_;
  double piece_length_;
  CsrbfSolver solver_;
  CsrbfField field_;
  BlockEvaluator evaluator_;
  bool begun_ = false;
};

} // namespace nendo::deform
