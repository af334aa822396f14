#pragma once
// Type-2 (the paper, 2.3.2): a smooth curve connects the samples of each fingertip, and is cut into
// pieces of constant arc length. Start and end points are the ends of a piece; each piece deforms
// the shape that the previous piece made.

#include <memory>
#include <optional>
#include <vector>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/midpoint_chain.hpp>
#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

class BlockEvaluator;
class BrushStroke;
class FingertipCurve;
class MaskedStep;
class SurfaceField;
class SurfaceStroke;

struct StrokeResult {
  FieldStatus status = FieldStatus::ok;
  int pieces = 0; ///< number of pieces that were cut and applied
};

/// The shape is in blocks, in float, and within 1e-5 of the model's diagonal of the result of
/// displace() in double for the same piece.
class NENDO_API Type2Deformer {
public:
  static constexpr int max_pieces = 16; ///< limit per call, without `injective`

  /// Allocates for the shape (3 by #vertices) and for `control_points` fingertips. piece_length is
  /// > 0, in model units. With `injective`, a piece consists of as many links as necessary; a call
  /// makes at most InjectiveOptions::max_links, and the rest waits for the next call. With
  /// keep_volume, it consists of one or two midpoint steps, and `injective` is ignored.
  Type2Deformer(Points shape, Eigen::Index control_points, double piece_length,
                const DeformerOptions& options);
  /// Works on a shape that other deformers may use before or after it. Call release() before
  /// another one uses it. `shape` must outlive the deformer.
  Type2Deformer(SculptedShape& shape, Eigen::Index control_points, double piece_length,
                const DeformerOptions& options);
  /// Measures distances along the surface. The field must have the shape's layout, and contains the
  /// masks. All points pull, and each call deforms all the way to the tips, without pieces or
  /// links.
  Type2Deformer(SculptedShape& shape, std::shared_ptr<const SurfaceField> field);
  ~Type2Deformer();
  Type2Deformer(Type2Deformer&&) noexcept;
  Type2Deformer& operator=(Type2Deformer&&) noexcept;

  /// Starts curves at these fingertips (3 by control_points) without deforming the shape, and ends
  /// the previous stroke, which can then be undone. The status is ok, not_finite, or, with
  /// `injective`, the status of building a field there.
  FieldStatus begin(const Points& tips);
  /// Does the same without ending the previous stroke.
  FieldStatus grab(const Points& tips);
  /// Releases the shape until the next begin() or grab(). With `is_step`, ends the stroke.
  void release(bool is_step) noexcept;
  /// Moves the shape in its history, and begins a new stroke at `tips`. On failure the shape is
  /// unchanged.
  FieldStatus go(HistoryMove move, const Points& tips);
  /// Extends the curves to `tips` and applies the complete pieces. The rest, less than one and a
  /// half pieces, waits for the next call. A jump is divided into at most max_pieces, so that the
  /// time of a call is bounded. Does not allocate. A piece without a usable field is skipped. If a
  /// fingertip is not finite, nothing changes and the status is not_finite.
  StrokeResult stroke_to(const Points& tips);
  /// Does the same, but deforms all the way to `tips`.
  StrokeResult end_at(const Points& tips);

  /// Returns the shape that the deformer works on, with its history.
  const SculptedShape& sculpted() const noexcept { return *shape_; }
  const BlockLayout& layout() const noexcept { return shape_->layout(); }
  /// Returns the shape. BlockShape::follow() brings a copy of it up to date.
  const BlockShape& shape() const noexcept { return shape_->shape(); }
  /// Returns the fields that the last call applied to the shape. Their centres are the fingertips
  /// rounded by BlockLayout::rounded(). Empty for distances along the surface.
  const FieldSequence& fields() const noexcept { return fields_; }
  /// Returns whether a brush changed the shape in the last call, so that fields() alone do not give
  /// it.
  bool is_brushed() const noexcept { return is_brushed_; }
  /// Returns whether a mask protects vertices, which fields() do not contain either.
  bool is_masked() const noexcept;
  /// Returns the stroke along the surface; null: distances are straight.
  const SurfaceStroke* along() const noexcept { return along_.get(); }
  /// Returns the report of the last call, the worst of its pieces; default values unless the
  /// deformer is injective.
  const ChainReport& report() const noexcept { return report_; }

private:
  /// A member function of the curve that takes the next tips.
  using Lead = void (FingertipCurve::*)(const Points&);

  Type2Deformer(std::unique_ptr<SculptedShape> own, Eigen::Index control_points,
                double piece_length, const DeformerOptions& options);
  void forget_last() noexcept;
  StrokeResult follow(const Points& tips, Lead lead);
  const Points& pulling(const Points& tips);
  void begin_piece();
  FieldStatus pull_piece();
  FieldStatus apply_piece();
  FieldStatus apply_links();
  FieldStatus apply_steps();
  FieldStatus apply(const CsrbfField& field);

  std::unique_ptr<SculptedShape> own_; ///< null if the caller owns the shape
  SculptedShape* shape_;
  std::unique_ptr<FingertipCurve> curve_;
  Points current_;                           ///< last cuts of the curves
  Points next_;                              ///< end points of the piece
  std::vector<Eigen::Index> pulling_points_; ///< points whose brush is Brush::pull
  Points pulling_;                           ///< the tips of pulling_points_
  Points step_;
  Points rounded_;    ///< current_ of pulling_points_, rounded to float
  Supports supports_; ///< supports with radii rounded to float
  CsrbfSolver solver_;
  CsrbfField field_;
  FieldSequence fields_;
  std::unique_ptr<BlockEvaluator> evaluator_;
  std::optional<InjectiveChain> chain_;
  std::optional<MidpointChain> steps_; ///< with keep_volume
  int max_links_ = 0;
  ChainReport report_;
  std::unique_ptr<MaskedStep> masked_;
  std::unique_ptr<BrushStroke> brushes_; ///< null: all pull, or do nothing
  std::unique_ptr<SurfaceStroke> along_;
  bool is_brushed_ = false;
  bool begun_ = false;
};

} // namespace nendo::deform
