#pragma once
// Type-2 (the paper, 2.4): the fingertips' samples are joined by a smooth curve, which is cut at a
// constant arc length. Start and end points are neighbouring cuts; each piece deforms the current
// shape, which becomes the start of the next.

#include <memory>
#include <optional>
#include <utility>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/fingertip_curve.hpp>

namespace nendo::deform {

class ShapeHistory;

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
  ~Type2Deformer();
  Type2Deformer(Type2Deformer&&) noexcept;
  Type2Deformer& operator=(Type2Deformer&&) noexcept;

  /// Starts a curve at these fingertips (3 by control_points) without deforming anything. singular
  /// only if injective, when nothing could be held there; not_finite.
  FieldStatus begin(const Points& tips);
  /// Extends the curves to `tips` and deforms by the pieces that are whole (FingertipCurve): what
  /// is left, less than one and a half pieces, waits for the next call; a jump is made in at most
  /// FingertipCurve::most_pieces, so that the time of a call is bounded. No allocation. A piece
  /// without a usable field is skipped; fingertips that are not finite are ignored, as not_finite.
  StrokeResult stroke_to(const Points& tips);
  /// As stroke_to(), but all the way.
  StrokeResult end_at(const Points& tips);
  /// The shape becomes what it was when the last stroke began that changed it, and a new one begins
  /// at `tips`. Without one that can be undone, as begin().
  FieldStatus undo(const Points& tips);
  /// The shape becomes what it was before the last undo, if no stroke that changed it has ended
  /// since; the present one is dropped, and a new one begins at `tips`. Without such an undo
  /// nothing changes, and it is ok.
  FieldStatus redo(const Points& tips);
  /// How many strokes can be undone, without the present one, and how many undos redone.
  std::size_t undo_steps() const noexcept;
  std::size_t redo_steps() const noexcept;
  /// How many could be undone once, and went for want of memory.
  std::size_t forgotten_steps() const noexcept;

  const BlockLayout& layout() const noexcept { return layout_; }
  /// A copy is brought up to date by BlockShape::follow().
  const BlockShape& shape() const noexcept { return shape_.shape; }
  /// What the last call applied to the shape. Centres are the fingertips as float holds them
  /// (BlockLayout::rounded).
  const FieldSequence& fields() const noexcept { return fields_; }
  /// What the last call took, the worst of its pieces; all 0 unless it is injective.
  const ChainReport& report() const noexcept { return report_; }

private:
  /// Takes the samples' next tips to the curve.
  using Lead = void (FingertipCurve::*)(const Points&);

  FieldStatus take_hold(const Points& tips);
  StrokeResult follow(const Points& tips, Lead lead);
  FieldStatus apply_piece();
  FieldStatus apply_links();
  FieldStatus apply(const CsrbfField& field);

  BlockLayout layout_;
  BoundedShape shape_;
  FingertipCurve curve_;
  Points current_; ///< where the curves have been cut last
  Points next_;    ///< and where the piece leads
  Points step_;
  Points rounded_;    ///< current_, as float holds it
  Supports supports_; ///< with radii as float holds them
  CsrbfSolver solver_;
  CsrbfField field_;
  FieldSequence fields_;
  BlockEvaluator evaluator_;
  std::unique_ptr<ShapeHistory> history_;
  std::optional<InjectiveChain> chain_;
  int most_links_ = 0;
  ChainReport report_;
  bool begun_ = false;
};

} // namespace nendo::deform
