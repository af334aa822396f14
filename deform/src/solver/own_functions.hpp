#pragma once
// Psi of supports.hpp: the values of each own function at the start points within its radius, and
// what it adds to the matrix and to the field.

#include <cstdint>
#include <span>
#include <vector>

#include <nendo/deform/csrbf.hpp>

namespace nendo::deform {

/// A row for each start point, with three coordinates and an unused number, or with the four terms
/// of the polynomial. A row fills two SSE registers or one of AVX.
using Rows = Eigen::Matrix<double, Eigen::Dynamic, 4, Eigen::RowMajor>;

class OwnFunctions {
public:
  struct Value {
    std::uint32_t point;
    double psi;
  };

  /// Evaluates the functions, with a grid if there are many points. Allocates unless as many values
  /// fitted before. Returns false if there are more than CsrbfSolver::max_own_values.
  bool evaluate(Wendland kernel, const Points& starts, const Supports& supports);

  std::size_t size() const noexcept { return weights_.size(); }
  /// Returns the values of one function, by ascending point.
  std::span<const Value> values(std::size_t function) const noexcept {
    return {values_.data() + begins_[function], begins_[function + 1] - begins_[function]};
  }
  double weight(std::size_t function) const noexcept { return weights_[function]; }
  /// Returns a bound of the pairs of points that share a function, and so of the work and of the
  /// entries.
  double pairs() const noexcept;
  /// Returns the trace of Psi W Psi^T.
  double trace() const noexcept;
  /// Writes the diagonal of Psi W Psi^T, one entry per point.
  void diagonal(Eigen::VectorXd& out) const noexcept;
  /// Returns the function's coefficient w_e sum_i psi_e(c_i) a_i.
  Eigen::RowVector4d coefficient(std::size_t function, const Rows& a) const noexcept;

private:
  std::vector<std::size_t> begins_{0};
  std::vector<Value> values_;
  std::vector<double> weights_;
};

} // namespace nendo::deform
