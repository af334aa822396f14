#pragma once
// The loops of a PressProblem over all places, which take most of its time.

#include <array>
#include <cstddef>

namespace nendo::deform {

/// Arrays of numbers, one per place, padded to `stride`, and matrices with a row of `stride`
/// numbers a place. They are aligned for whole vectors.
struct PressArrays {
  std::size_t count, stride; ///< stride: a multiple of press_lanes
  const double* x;
  const double* y;
  const double* z;
  std::array<const double*, 3> normal;
  double* psi; ///< psi_ij
  double* a;   ///< n_i . n_j psi_ij
};
inline constexpr std::size_t press_lanes = 8;

/// Sets the matrices to those of Wendland's C2, with `ridge` added to a's diagonal. Padding must
/// be farther than the radius from all places.
void fill_press_matrices(const PressArrays& arrays, double radius, double ridge) noexcept;
/// Sweeps l >= 0 and w = a l - p by projected Gauss-Seidel until no l_i changes by more than
/// `least`, but at most so many times.
void sweep_pressure(const PressArrays& arrays, double* l, double* w, double least,
                    int max_sweeps) noexcept;
/// Adds change * row to each of three arrays of a row's length.
void add_row(const PressArrays& arrays, const double* row, const std::array<double, 3>& change,
             const std::array<double*, 3>& to) noexcept;

/// Cells of space, slope_cells a row and slope_cells rows a layer, of which the first `counts` are
/// used. The first one begins at the origin.
inline constexpr std::size_t slope_cells = 32;
struct SlopeCells {
  float size, radius; ///< a cell's size; the functions' radius
  std::array<std::size_t, 3> counts;
  float* sums; ///< one per cell; rows along x
};
/// Adds to each cell coefficient * the steepest |psi'| of Wendland's C2 about `centre` in that
/// cell.
void add_slopes(const SlopeCells& cells, const std::array<float, 3>& centre,
                float coefficient) noexcept;
/// Returns the largest sum of a cell.
float steepest_slope(const SlopeCells& cells) noexcept;

} // namespace nendo::deform
