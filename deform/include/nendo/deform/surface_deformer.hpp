#pragma once
// Type-1 (the paper, 2.3.1) with distances along the surface. The radial functions belong to the
// surface at rest, and commits do not change them, so a grab solves no equations.

#include <memory>

#include <nendo/deform/field_sequence.hpp>
#include <nendo/deform/injective_chain.hpp>
#include <nendo/deform/sculpted_shape.hpp>
#include <nendo/deform/surface_field.hpp>

namespace nendo::deform {

/// The functions do what those of Type1Deformer do, without allocation.
class NENDO_API SurfaceDeformer {
public:
  /// Allocates. The field must have the shape's layout, and `shape` must outlive the deformer.
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
  /// Writes the displacement of the rest shape by the last apply(). Allocates only if `move` is too
  /// small.
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
  SurfaceField::Coefficients coefficients_; ///< coefficients of the last apply(); 0: at rest
  FieldSequence fields_;
  bool grabbed_ = false;
};

/// A stroke of Type-2 with distances along the surface. The radial functions belong to the surface
/// at rest and do not change, so the field is linear in the points' displacements, and any division
/// of a path gives the same shape. So each step deforms the shape at the stroke's beginning by the
/// whole displacement so far. Rounding errors do not accumulate, however short the steps are.
class NENDO_API SurfaceStroke {
public:
  /// Allocates; no other function does. The field must have this layout.
  SurfaceStroke(const BlockLayout& layout, std::shared_ptr<const SurfaceField> field);

  /// Begins a stroke at these points (3 by #points), which must be usable. It deforms the shape
  /// that the first go_to() gets.
  void begin(const Points& tips) noexcept;
  /// Deforms the shape by the stroke up to `tips`, which must be usable. If the result exceeds the
  /// range of float, nothing changes and the status is not_finite.
  FieldStatus go_to(const Points& tips, SculptedShape::Parts& parts) noexcept;
  /// Clears the displacement of the last go_to(), so that is_moved() and write_move() do not report
  /// it again.
  void clear() noexcept { step_.all.setZero(); }

  /// Returns whether the last go_to() moved anything.
  bool is_moved() const noexcept { return !step_.all.isZero(0.0F); }
  /// Writes the displacement of the previous shape by the last go_to(). Allocates only if `move` is
  /// too small.
  void write_move(SurfaceMove& move) const { field_->write_move(step_, move); }
  /// Returns how many vectors write_move() writes.
  Eigen::Index vector_count() const noexcept {
    return static_cast<Eigen::Index>(field_->vector_count());
  }

private:
  std::shared_ptr<const SurfaceField> field_;
  Points starts_;
  Points way_;                       ///< displacement from starts_
  BlockShape first_;                 ///< shape at the stroke's beginning
  double first_extent_ = 0.0;        ///< upper bound of the coordinates of first_
  SurfaceField::Coefficients whole_; ///< coefficients of the displacement so far
  SurfaceField::Coefficients next_;  ///< coefficients of the next displacement
  SurfaceField::Coefficients step_;  ///< next_ minus whole_
  bool has_first_ = false;
};

} // namespace nendo::deform
