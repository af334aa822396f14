#pragma once
// Type-1 (the paper, 2.3.1) with distances along the surface. The functions belong to the surface
// at rest and stay as they are, whatever is committed, so a grab needs no equations.

#include <memory>

#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/surface_field.hpp>

namespace nendo::deform {

/// Its functions do what those of Type1Deformer do, also without allocation.
class NENDO_API SurfaceDeformer {
public:
  /// Allocates. The field must be of the shape's layout, and `shape` must outlive the deformer.
  SurfaceDeformer(SculptedShape& shape, std::shared_ptr<const SurfaceField> field);

  FieldStatus grab(const Points& starts);
  /// Before the first grab, the status is singular and `out` is the rest shape.
  FieldStatus apply(const Points& ends, BlockShape& out);
  FieldStatus commit(const Points& ends);
  void release(bool is_step) noexcept;
  void drop(bool is_step) noexcept;
  FieldStatus go(HistoryMove move, const Points& tips);
  FieldStatus take_back(const Points& tips);

  const BlockLayout& layout() const noexcept { return shape_->layout(); }
  const BlockShape& rest() const noexcept { return shape_->shape(); }
  /// Returns how many vectors write_move() writes.
  Eigen::Index vector_count() const noexcept {
    return static_cast<Eigen::Index>(field_->vector_count());
  }
  /// Always empty: there is no closed-form displacement field.
  const FieldSequence& fields() const noexcept { return fields_; }
  /// Writes what displaced the rest shape in the last apply(). Allocates only if `move` is
  /// too small.
  void write_move(SurfaceMove& move) const { field_->write_move(coefficients_, move); }
  ChainReport report() const noexcept { return {}; }
  /// Returns whether the last apply() moved anything.
  bool is_moved() const noexcept { return !coefficients_.all.isZero(0.0F); }

private:
  void absorb() noexcept;
  void take_hold(const Points& starts) noexcept;

  SculptedShape* shape_;
  std::shared_ptr<const SurfaceField> field_;
  Points starts_;
  Points vectors_;
  SurfaceField::Coefficients coefficients_; ///< used by the last apply(); 0: at rest
  FieldSequence fields_;
  bool grabbed_ = false;
};

/// A stroke of Type-2 with distances along the surface. The functions belong to the surface at rest
/// and stay as they are, so that the field is linear in the points' ways: however a way is cut into
/// pieces, they make the same shape. So the shape at a stroke's beginning is kept, and each step
/// makes the shape of it and of the whole way up to there. Nothing is lost to rounding, however
/// short the steps are.
class NENDO_API SurfaceStroke {
public:
  /// Allocates; no other function does. The field must be of that layout.
  SurfaceStroke(const BlockLayout& layout, std::shared_ptr<const SurfaceField> field);

  /// Begins at these points (3 by #points), which must be usable, and of the shape as the first
  /// go_to() finds it.
  void begin(const Points& tips) noexcept;
  /// Makes the shape that of the stroke up to `tips`, which must be usable. If float could not hold
  /// it, nothing happens and the status is not_finite.
  FieldStatus go_to(const Points& tips, SculptedShape::Parts& parts) noexcept;
  /// Forgets what the last go_to() did, so that is_moved() and write_move() do not report it again.
  void clear() noexcept { step_.all.setZero(); }

  /// Returns whether the last go_to() moved anything.
  bool is_moved() const noexcept { return !step_.all.isZero(0.0F); }
  /// Writes what displaced the previous shape in the last go_to(). Allocates only if `move` is
  /// too small.
  void write_move(SurfaceMove& move) const { field_->write_move(step_, move); }
  /// Returns how many vectors write_move() writes.
  Eigen::Index vector_count() const noexcept {
    return static_cast<Eigen::Index>(field_->vector_count());
  }

private:
  std::shared_ptr<const SurfaceField> field_;
  Points starts_;
  Points way_;                       ///< from there
  BlockShape first_;                 ///< the shape at the beginning
  double first_extent_ = 0.0;        ///< no coordinate of it is larger
  SurfaceField::Coefficients whole_; ///< coefficients of the way so far
  SurfaceField::Coefficients next_;  ///< and of the one that is tried
  SurfaceField::Coefficients step_;  ///< the difference of both
  bool has_first_ = false;
};

} // namespace nendo::deform
