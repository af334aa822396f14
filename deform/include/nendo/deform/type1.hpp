#pragma once
// Type-1 (the paper, 2.3.1): the start points are frozen at the grab. In each tick only the end
// points move, so all data that depend only on the start points are kept, including the weight of
// each displacement at each vertex. Each tick deforms the rest shape again, so nothing accumulates.

#include <memory>
#include <optional>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/midpoint_chain.hpp>
#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/vertex_blocks.hpp>

namespace nendo::deform {

class BlockEvaluator;
class CardinalWeights;
class MaskedStep;
struct BoundedShape;

/// Shapes are in blocks, in float, and within 1e-5 of the model's diagonal of the result of
/// displace() in double. Functions do not allocate if `out` has the layout's size and there are at
/// most CsrbfSolver::lean_size start points.
class NENDO_API Type1Deformer {
public:
  /// Allocates for the rest shape (3 by #vertices) and for `control_points` start points. With
  /// `injective`, every apply() moves straight from the start points in as many links as necessary,
  /// so that the shape depends only on the ends, even if a pair is kept apart. With keep_volume, it
  /// uses midpoint steps and ignores `injective`.
  Type1Deformer(Points rest, Eigen::Index control_points, const DeformerOptions& options);
  /// Works on a shape that other deformers may use before or after it. Call release() or grab()
  /// before another one uses it. `shape` must outlive the deformer.
  Type1Deformer(SculptedShape& shape, Eigen::Index control_points, const DeformerOptions& options);
  ~Type1Deformer();
  Type1Deformer(Type1Deformer&&) noexcept;
  Type1Deformer& operator=(Type1Deformer&&) noexcept;

  /// Freezes the start points (3 by control_points); the shape is then the rest shape again. On
  /// failure, the previous grab is kept.
  FieldStatus grab(const Points& starts);
  /// Writes to `out` the rest shape, deformed so that the start points move to `ends`. Outside all
  /// supports, `out` is written only if it differs from the rest shape. On failure, `out` is the
  /// last valid shape. Before the first grab, the status is singular and `out` is the rest shape.
  FieldStatus apply(const Points& ends, BlockShape& out);
  /// Makes the shape of the last apply() the rest shape, and `ends` the new start points.
  FieldStatus commit(const Points& ends);
  /// Makes the shape of the last apply() the rest shape, and releases it until the next grab().
  /// With `is_step`, an undo can revert this; without, only together with the next commit.
  void release(bool is_step) noexcept;
  /// Does the same, but discards changes since the last commit: the rest shape is unchanged.
  void drop(bool is_step) noexcept;
  /// Moves the rest shape in its history, and makes `tips` the start points. Changes by apply()
  /// since the last commit are discarded; a reset makes them a separate step. On failure nothing
  /// changes.
  FieldStatus go(HistoryMove move, const Points& tips);
  /// Undoes the changes by apply() since the last commit, as a separate step, and makes `tips` the
  /// start points. A redo restores them, unless there was no memory for them. Older steps are kept.
  FieldStatus take_back(const Points& tips);

  /// Returns the shape that the deformer works on, with its history.
  const SculptedShape& sculpted() const noexcept { return *shape_; }
  const BlockLayout& layout() const noexcept { return shape_->layout(); }
  const BlockShape& rest() const noexcept { return shape_->shape(); }
  /// Returns the fields that deform the rest shape into that of the last apply(): one, or one per
  /// link, or two per midpoint step. The centres are the start points rounded by
  /// BlockLayout::rounded(); those of later links are the end points of the previous link.
  const FieldSequence& fields() const noexcept { return fields_; }
  /// Returns whether a mask protects vertices, so that fields() alone do not give the shape.
  bool is_masked() const noexcept;
  /// Returns the report of the last apply(); default values unless the deformer is injective.
  ChainReport report() const noexcept { return chain_ ? chain_->report() : ChainReport{}; }
  /// Returns the bytes of weights in use; 0 if fields are evaluated instead.
  std::size_t weight_bytes() const noexcept;

private:
  Type1Deformer(std::unique_ptr<SculptedShape> own, Eigen::Index control_points,
                const DeformerOptions& options);
  const BoundedShape& rest_shape() const noexcept;
  bool is_moved() const noexcept { return in_links_ || !displacements_.isZero(0.0); }
  void forget_applied() noexcept;
  void absorb();
  FieldStatus apply_links(const Points& ends, BlockShape& out);
  FieldStatus apply_steps(const Points& ends, BlockShape& out);
  template <class Chain>
  FieldStatus follow_links(Chain& chain);
  FieldStatus build(const Points& starts);
  CsrbfSolver& solver() noexcept { return chain_ ? chain_->start_solver() : solver_; }
  void take_hold();
  void draw(BlockShape& out);

  std::unique_ptr<SculptedShape> own_; ///< null if the caller owns the shape
  SculptedShape* shape_;               ///< the rest shape
  Points starts_;
  Points rounded_;       ///< the start points, rounded to float
  Points displacements_; ///< last displacements with a solution
  Points asked_;
  Supports supports_;  ///< supports with radii rounded to float
  CsrbfSolver solver_; ///< solver for the start points, unless the chain has it
  CsrbfField field_;   ///< used unless the shape is made in several links
  FieldSequence fields_;
  std::unique_ptr<BlockEvaluator> evaluator_;
  std::unique_ptr<CardinalWeights> weights_;
  std::optional<InjectiveChain> chain_;
  std::optional<MidpointChain> steps_; ///< with keep_volume
  std::unique_ptr<MaskedStep> masked_;
  std::unique_ptr<BoundedShape> linked_; ///< the shape that a chain of several links makes
  bool in_links_ = false;                ///< the last apply() made several links
  bool grabbed_ = false;
};

} // namespace nendo::deform
