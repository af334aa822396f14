#pragma once
// A field in a layout's coordinates, in the form that the vector code takes.

#include <array>
#include <cstdint>
#include <vector>

#include <hwy/aligned_allocator.h>

#include <nendo/deform/field.hpp>
#include <nendo/deform/vertex_blocks.hpp>

#include "simd/field_kernels.hpp"

namespace nendo::deform {

/// An array of numbers, aligned for whole vectors.
template <class T>
using VectorArray = hwy::AlignedFreeUniquePtr<T[]>;

class BlockField {
public:
  /// Allocates for `entries` functions.
  BlockField(const BlockLayout& layout, Eigen::Index entries);

  /// What becomes of functions whose coefficients are all zero. They belong to fingertips that
  /// rest, out of reach of those that move.
  enum class Zeros { left_out, kept };

  /// Takes over a field. Returns false if a number in it is not finite or is too large for float;
  /// this is then the zero field. Allocates only for more entries than ever before.
  bool assign(const CsrbfField& field, Zeros zeros);
  const FieldView& view() const noexcept { return view_; }
  const FieldEntry<double>* precise_entries() const noexcept { return precise_entries_.data(); }
  /// Returns a bound of the coordinates of s(x), for all x whose coordinates are at most `extent`.
  double bound(double extent) const noexcept;

private:
  void reserve(Eigen::Index entries);
  bool assign_entries(const CsrbfField& field, Zeros zeros);
  void assign_entry(std::size_t at, const Eigen::Vector3d& centre, double radius,
                    const Eigen::Vector3d& coefficient, const CsrbfField& field);

  Eigen::Vector3d origin_;
  double inverse_unit_; ///< exact: units are powers of two
  double tolerance_;    ///< the largest error of float sums, in units
  Eigen::Index capacity_ = 0;
  Eigen::Index size_ = 0;
  VectorArray<float> x_, y_, z_, squared_radius_;
  VectorArray<std::uint32_t> names_;
  std::vector<FieldEntry<float>> entries_;
  std::vector<FieldEntry<double>> precise_entries_;
  std::array<std::array<double, 4>, 3> polynomial_{};
  double sum_of_coefficients_ = 0.0;
  double largest_coefficient_ = 0.0;
  bool in_range_ = true; ///< whether float sums hold the numbers
  FieldView view_{};
};

} // namespace nendo::deform
