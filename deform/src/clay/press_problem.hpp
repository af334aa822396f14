#pragma once
// The field that pushes a surface out of bodies, found by projected Gauss-Seidel. It is
//   s(x) = sum_i (l_i n_i + t_i) psi(|x - c_i| / r),  l_i >= 0,
// with the least energy of those that push each place c_i by its depth p_i along its normal n_i or
// more: w = A l - p >= 0, l >= 0, l.w = 0, with A_ij = n_i.n_j psi_ij. The tangential t_i take the
// places along, as far as Coulomb's friction permits.

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include <Eigen/Core>

#include "clay/contact_points.hpp"
#include "field/block_field.hpp"
#include "simd/press_kernels.hpp"

namespace nendo::deform {

/// `gram` is the sum of psi_ij a_i a_j^T over all pairs of coefficients. Returns an L with
/// |s(x) - s(y)| <= L |x - y|, by the field's norm in the native space (jacobian.hpp).
double bound_of_gram(const Eigen::Matrix3d& gram, double radius) noexcept;

/// Bounds the slope cell by cell of space: nowhere is it steeper than the sum of |a_i| |psi'| / r
/// over the functions that reach there. Where many functions push side by side into one direction,
/// that is less than bound_of_gram(), which grows with the surface that they push. Belongs to one
/// thread. After the constructor nothing allocates.
class SlopeGrid {
public:
  SlopeGrid();

  /// Begins with no function. All will be of that radius, with centres in that box.
  void begin(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double radius) noexcept;
  /// Adds a function with a coefficient of that length.
  void add(const Eigen::Vector3d& centre, double coefficient) noexcept;
  /// Returns an L with |s(x) - s(y)| <= L |x - y|.
  double lipschitz_bound() const noexcept;

private:
  Eigen::Vector3d low_ = Eigen::Vector3d::Zero();
  double radius_ = 1.0;
  SlopeCells cells_{};
  VectorArray<float> sums_; ///< one per cell
};

/// What a place's friction needs.
struct Friction {
  Eigen::Vector3d way;           ///< where what touches it has gone
  double load = 0.0;             ///< in lengths, as l_i; what is pressed adds to it
  std::uint8_t* slips = nullptr; ///< its state, which solve_friction() sets
};

class PressProblem {
public:
  /// Allocates for so many places.
  explicit PressProblem(std::size_t most);

  /// Sets the places and the radius. Places may coincide. The other functions are for these.
  void assign(std::span<const ContactPoint> points, double radius) noexcept;
  /// Finds l for the points' depths, with `extra` added to each.
  void solve_pressure(double extra) noexcept;
  /// Finds t, one Friction per place, in the order of the points; `coefficient` is Coulomb's. Slip
  /// begins at the limit and ends below 0.8 of it, so that tremor does not flicker. Call it after
  /// solve_pressure().
  void solve_friction(std::span<const Friction> frictions, double coefficient) noexcept;

  /// Returns l_i n_i + t_i.
  Eigen::Vector3d coefficient(std::size_t i) const noexcept;
  double pressure(std::size_t i) const noexcept { return l_[i]; }
  /// Returns an L with |s(x) - s(y)| <= L |x - y|, by the field's norm in the native space of
  /// Wendland's C2 (jacobian.hpp). Where L < 1, nothing folds. Where that is more than `enough`, it
  /// is the lesser of that and a SlopeGrid's.
  double lipschitz_bound(double enough) noexcept;

  /// Gauss-Seidel ends after so many sweeps, or when nothing moves any more.
  static constexpr int max_sweeps = 60;

private:
  using Three = std::array<VectorArray<double>, 3>; ///< an array per axis

  PressArrays arrays() const noexcept;
  double bound_of_slopes() noexcept;
  static Eigen::Vector3d at(const Three& three, std::size_t i) noexcept {
    return {three[0][i], three[1][i], three[2][i]};
  }
  const double* psi_row(std::size_t i) const noexcept { return psi_.get() + i * stride_; }
  bool sweep_friction(std::span<const Friction> frictions, double coefficient,
                      double least) noexcept;

  double radius_ = 1.0;
  std::size_t max_;
  std::size_t count_ = 0, stride_ = 0; ///< places; with the padding
  VectorArray<double> psi_;            ///< psi_ij
  VectorArray<double> a_;              ///< A_ij
  Three places_, normals_;
  VectorArray<double> p_, l_, w_; ///< w = A l - p
  Three t_;
  Three left_; ///< the rest of the ways, where the field does not lead yet
  SlopeGrid slopes_;
};

} // namespace nendo::deform
