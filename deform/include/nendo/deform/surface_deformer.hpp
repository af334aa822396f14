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
  /// Writes what displaced the rest shape in the last apply(). Allocates only if `move` has no
  /// room.
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

} // namespace nendo::deform
