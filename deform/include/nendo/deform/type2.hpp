#pragma once
// Type-2 (the paper, 2.4): start and end points are neighbouring samples of each fingertip's curve.
// The curve is cut at a constant arc length; each piece deforms the current shape, which becomes
// the start of the next.

#include <optional>
#include <utility>

#include <nendo/deform/deformer_options.hpp>

namespace nendo::deform {

struct StrokeResult {
  FieldStatus status = FieldStatus::ok;
  int pieces = 0; ///< how many pieces were cut and applied
};

/// The shape is in blocks, in float, and within 1e-5 of the model's diagonal of what displace()
/// makes in double of the same piece.
class Type2Deformer {
public:
  /// shape: 3 by #vertices. piece_length > 0 in model units. With `injective` a piece is made in as
  /// many links as it takes, at most InjectiveOptions::most_links a call; then the rest waits.
  Type2Deformer(Points shape, Eigen::Index control_points, double piece_length,
                const DeformerOptions& options);
  /// One radius > 0 for all, in model units.
  Type2Deformer(Points shape, Eigen::Index control_points, double radius, double piece_length,
                CsrbfOptions csrbf, const EvaluationOptions& evaluation = {})
      : Type2Deformer(std::move(shape), control_points, piece_length,
                      {one_radius(radius), csrbf, evaluation, {}}) {}

  /// Starts a curve at these fingertips (3 by control_points) without deforming anything. singular
  /// only if injective, when nothing could be held there; not_finite.
  FieldStatus begin(const Points& tips);
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
  /// What the last call took, the worst of its pieces; all 0 unless it is injective.
  const ChainReport& report() const noexcept { return report_; }

  static constexpr int most_pieces = 16;

private:
  StrokeResult advance_to_target(int pieces);
  StrokeResult advance(int pieces);
  FieldStatus apply_piece();
  FieldStatus apply_links();

  BlockLayout layout_;
  BoundedShape shape_;
  Points current_; ///< where the curves have been cut last
  Points target_;  ///< where the fingertips are
  Points step_;
  Points rounded_; ///< current_, as float holds it
  Points asked_;
  Supports supports_; ///< with radii as float holds them
  double piece_length_;
  CsrbfSolver solver_;
  CsrbfField field_;
  BlockEvaluator evaluator_;
  std::optional<InjectiveChain> chain_;
  int most_links_ = 0;
  ChainReport report_;
  bool begun_ = false;
};

} // namespace nendo::deform
