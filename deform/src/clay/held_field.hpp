#pragma once
// The CSRBF field that takes places along which are held, both ways:
//   s(x) = sum_i a_i psi(|x - c_i| / r), with (Psi + ridge) a = ways.

#include <cstddef>
#include <span>

#include <Eigen/Core>

namespace nendo::deform {

class HeldField {
public:
  /// Allocates for so many places.
  explicit HeldField(std::size_t most);

  void add(std::size_t at, const Eigen::Vector3d& place, const Eigen::Vector3d& way) noexcept;
  /// Solves for the first `count` places. Returns an L with |s(x) - s(y)| <= L |x - y|.
  double solve(std::size_t count, double radius) noexcept;
  Eigen::Vector3d place(std::size_t at) const noexcept { return column(places_, at); }
  Eigen::Vector3d coefficient(std::size_t at) const noexcept { return column(coefficients_, at); }
  /// Returns s there.
  Eigen::Vector3d field_at(const Eigen::Vector3d& place) const noexcept;

private:
  static Eigen::Vector3d column(const Eigen::Matrix3Xd& all, std::size_t at) noexcept {
    return all.col(static_cast<Eigen::Index>(at));
  }

  Eigen::Index count_ = 0;
  double radius_ = 1.0;
  Eigen::Matrix3Xd places_, ways_, coefficients_;
  Eigen::MatrixXd psi_, factor_;
};

} // namespace nendo::deform
