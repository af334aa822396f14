#pragma once
// Type-1 (the paper, 2.4): the start points are frozen when the operator grabs. Every tick only the
// end points move, so everything that depends on start points alone is kept, down to what each
// vertex gets of each displacement, and the rest shape is deformed anew: nothing accumulates.

#include <memory>
#include <optional>
#include <utility>

#include <nendo/deform/deformer_options.hpp>
#include <nendo/deform/field_sequence.hpp>

namespace nendo::deform {

class CardinalWeights;
class ShapeHistory;

/// Shapes are in blocks, in float, and within 1e-5 of the model's diagonal of what displace() makes
/// in double. Functions allocate nothing, if `out` has the layout's size and
/// there are at most CsrbfSolver::lean_size start points.
class Type1Deformer {
public:
  /// rest: 3 by #vertices. Allocates for `control_points` start points. With `injective` every
  /// apply() goes straight from the start points in as many links as it takes: the shape depends on
  /// the ends alone, also where a pair is held apart.
  Type1Deformer(Points rest, Eigen::Index control_points, const DeformerOptions& options);
  /// One radius > 0 for all, in model units.
  Type1Deformer(Points rest, Eigen::Index control_points, double radius, CsrbfOptions csrbf,
                const EvaluationOptions& evaluation = {})
      : Type1Deformer(std::move(rest), control_points,
                      {one_radius(radius), csrbf, evaluation, {}}) {}
  ~Type1Deformer();
  Type1Deformer(Type1Deformer&&) noexcept;
  Type1Deformer& operator=(Type1Deformer&&) noexcept;

  /// Freezes the start points (3 by control_points); nothing is displaced any more. Not on failure:
  /// the last good grab stays.
  FieldStatus grab(const Points& starts);
  /// Deforms the rest shape so that the start points go to `ends`, into `out`. Where no support
  /// reaches, `out` is written only if it is not the rest shape there already. On failure `out` is
  /// the last good shape; before the first grab, singular and the rest shape.
  FieldStatus apply(const Points& ends, BlockShape& out);
  /// The shape that apply() last gave becomes the rest shape, and `ends` the new start points.
  FieldStatus commit(const Points& ends);
  /// The rest shape becomes what it was before the last commit, and `tips` the start points; what
  /// apply() made of it since is dropped. Without a commit that can be undone, as grab().
  FieldStatus undo(const Points& tips);
  /// The rest shape becomes what it was before the last undo, if there was no commit since; for
  /// the rest as undo(). Without such an undo nothing changes, and it is ok.
  FieldStatus redo(const Points& tips);
  /// How many commits can be undone, and how many undos redone.
  std::size_t undo_steps() const noexcept;
  std::size_t redo_steps() const noexcept;
  /// How many could be undone once, and went for want of memory.
  std::size_t forgotten_steps() const noexcept;

  const BlockLayout& layout() const noexcept { return layout_; }
  const BlockShape& rest() const noexcept { return rest_.shape; }
  /// What makes the last apply()'s shape of the rest shape: one field, or as many as it has links.
  /// Centres are the start points as float holds them (BlockLayout::rounded); those of later links
  /// are where the one before leads.
  const FieldSequence& fields() const noexcept { return fields_; }
  /// What the last apply() took; all 0 unless it is injective.
  ChainReport report() const noexcept { return chain_ ? chain_->report() : ChainReport{}; }
  /// Bytes of weights in use; 0 if fields are evaluated instead.
  std::size_t weight_bytes() const noexcept;

private:
  FieldStatus apply_links(const Points& ends, BlockShape& out);
  FieldStatus follow_links();
  FieldStatus build(const Points& starts);
  CsrbfSolver& solver() noexcept { return chain_ ? chain_->start_solver() : solver_; }
  void take_hold();
  void draw(BlockShape& out);

  BlockLayout layout_;
  BoundedShape rest_;
  Points starts_;
  Points rounded_;       ///< the start points as float holds them
  Points displacements_; ///< the last that had a solution
  Points asked_;
  Supports supports_;  ///< with radii as float holds them
  CsrbfSolver solver_; ///< of the start points, unless the chain has it
  CsrbfField field_;   ///< unless the shape is in several links
  FieldSequence fields_;
  BlockEvaluator evaluator_;
  std::unique_ptr<CardinalWeights> weights_;
  std::unique_ptr<ShapeHistory> history_;
  std::optional<InjectiveChain> chain_;
  std::optional<BoundedShape> linked_; ///< the shape that a chain of several links makes
  bool in_links_ = false;              ///< the last apply() made it so
  bool grabbed_ = false;
};

} // namespace nendo::deform
