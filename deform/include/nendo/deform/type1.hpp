#pragma once
// Type-1 (the paper, 2.3.1): the start points are frozen when the operator grabs. Every tick only
// the end points move, so everything that depends on start points alone is kept, down to what each
// vertex gets of each displacement, and the rest shape is deformed again: nothing accumulates.

#include <memory>
#include <optional>
#include <utility>

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
  /// `injective`, every apply() goes straight from the start points in as many links as it takes,
  /// so that the shape depends on the ends alone, also where a pair is held apart. With keep_volume
  /// it goes there in midpoint steps; the two do not go together, and `injective` is then left out.
  Type1Deformer(Points rest, Eigen::Index control_points, const DeformerOptions& options);
  /// Works on a shape that other deformers work on before or after it. Call release() or grab()
  /// before another one does. `shape` must outlive the deformer.
  Type1Deformer(SculptedShape& shape, Eigen::Index control_points, const DeformerOptions& options);
  /// Uses one radius > 0 for all start points, in model units.
  Type1Deformer(Points rest, Eigen::Index control_points, double radius, CsrbfOptions csrbf,
                const EvaluationOptions& evaluation = {})
      : Type1Deformer(std::move(rest), control_points,
                      {one_radius(radius), csrbf, evaluation, {}}) {}
  ~Type1Deformer();
  Type1Deformer(Type1Deformer&&) noexcept;
  Type1Deformer& operator=(Type1Deformer&&) noexcept;

  /// Freezes the start points (3 by control_points); the shape is then the rest shape again. On
  /// failure, the last good grab stays.
  FieldStatus grab(const Points& starts);
  /// Writes into `out` the rest shape deformed so that the start points go to `ends`. Where no
  /// support reaches, `out` is written only if it differs from the rest shape. On failure, `out` is
  /// the last good shape. Before the first grab, the status is singular and `out` is the rest
  /// shape.
  FieldStatus apply(const Points& ends, BlockShape& out);
  /// Makes the shape that apply() last gave the rest shape, and `ends` the new start points.
  FieldStatus commit(const Points& ends);
  /// Makes the shape that apply() last gave the rest shape, which nothing holds until the next
  /// grab(). With `is_step`, an undo can go back before it; without, only together with the next
  /// commit.
  void release(bool is_step) noexcept;
  /// Does the same, but what was applied since the last commit is not kept: the rest shape stays.
  void drop(bool is_step) noexcept;
  /// Changes the rest shape, and makes `tips` the start points. What apply() made since the last
  /// commit is dropped; a reset makes it a step of its own. On failure nothing changes.
  FieldStatus go(HistoryMove move, const Points& tips);
  /// Undoes what apply() made since the last commit, as a step of its own, and makes `tips` the
  /// start points. A redo brings it back, unless there was no memory for it. Older steps stay.
  FieldStatus take_back(const Points& tips);

  /// Returns the shape that the deformer works on, with its history.
  const SculptedShape& sculpted() const noexcept { return *shape_; }
  const BlockLayout& layout() const noexcept { return shape_->layout(); }
  const BlockShape& rest() const noexcept { return shape_->shape(); }
  /// Returns the fields that make the last apply()'s shape from the rest shape: one, or one for
  /// each link, or two for each midpoint step. The centres are the start points rounded by
  /// BlockLayout::rounded(); those of later links are where the link before leads.
  const FieldSequence& fields() const noexcept { return fields_; }
  /// Returns whether a mask holds vertices, so that fields() is not all.
  bool is_masked() const noexcept;
  /// Returns what the last apply() took; all is 0 unless the deformer is injective.
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

  std::unique_ptr<SculptedShape> own_; ///< null if it was given
  SculptedShape* shape_;               ///< the rest shape
  Points starts_;
  Points rounded_;       ///< the start points as float holds them
  Points displacements_; ///< the last that had a solution
  Points asked_;
  Supports supports_;  ///< with radii as float holds them
  CsrbfSolver solver_; ///< the one for the start points, unless the chain has it
  CsrbfField field_;   ///< unless the shape is in several links
  FieldSequence fields_;
  std::unique_ptr<BlockEvaluator> evaluator_;
  std::unique_ptr<CardinalWeights> weights_;
  std::optional<InjectiveChain> chain_;
  std::optional<MidpointChain> steps_; ///< with keep_volume
  std::unique_ptr<MaskedStep> masked_;
  std::unique_ptr<BoundedShape> linked_; ///< the shape that a chain of several links makes
  bool in_links_ = false;                ///< the last apply() made it so
  bool grabbed_ = false;
};

} // namespace nendo::deform
