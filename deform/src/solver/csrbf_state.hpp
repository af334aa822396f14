#pragma once
// The state that CsrbfSolver keeps between build() and solve(). The paper's steps are here in a
// row: order, assembly and elimination are in csrbf_build.cpp, displacements and the field in
// csrbf.cpp. The evaluation is in field.hpp.

#include <array>
#include <memory>

#include <nendo/deform/csrbf.hpp>

#include "solver/polynomial_part.hpp"
#include "solver/solver_choices.hpp"

namespace nendo::deform {

class CsrbfSolver::State {
public:
  explicit State(const CsrbfOptions& options) : options_(options) {}

  SolverChoices choices;

  void reserve(Eigen::Index points);
  /// Builds for `supports`. The start points and the supports must be usable.
  FieldStatus build(const Points& starts);
  FieldStatus solve(const Points& displacements, CsrbfField& field);

  Supports supports;
  SolverEffort effort;

private:
  using Systems = std::array<std::unique_ptr<KernelSystem>, 3>; ///< lean, dense, sparse

  bool keeps_volume() const noexcept { return options_.keep_volume > 0.0; }
  /// Of M: three a start point, where its entries are matrices.
  Eigen::Index rows_of(Eigen::Index points) const noexcept {
    return keeps_volume() ? 3 * points : points;
  }
  bool has_polynomial() const noexcept {
    return options_.polynomial != Polynomial::none && !keeps_volume();
  }
  /// Returns whether p(x) is solved apart. With own functions it cannot join M, since a solution
  /// would then not be certain for every choice. So p(x) is what the shared functions alone would
  /// make it, and all functions together make up the rest.
  bool is_polynomial_apart() const noexcept { return has_polynomial() && own_.size() > 0; }
  void put_in_order(const Points& starts);
  KernelSystem::Assembled assemble(const OwnFunctions& own, Systems& systems,
                                   KernelSystem*& system);
  FieldStatus factorise(KernelSystem& system, double size);
  FieldStatus factorise_polynomial(double size);
  void solve_in_place(Rows& a, Eigen::Matrix4d& b, const Eigen::Matrix4d& sums);
  void take_right_side(const Points& displacements);
  Eigen::Vector3d coefficient(Eigen::Index place) const;
  void take_own_coefficients();
  bool write(CsrbfField& field, const Eigen::Matrix4d& b);

  CsrbfOptions options_;
  Points starts_;
  std::vector<std::uint32_t> order_; ///< start points, in the order of elimination
  Points ordered_starts_;
  Supports ordered_supports_; ///< points are places in that order
  OwnFunctions own_;
  OwnFunctions no_own_;            ///< stays empty
  Systems systems_;                ///< made when first needed
  KernelSystem* system_ = nullptr; ///< of M
  Systems shared_systems_;         ///< of its shared part, for a polynomial apart
  KernelSystem* shared_system_ = nullptr;
  PolynomialPart polynomial_;
  bool merged_ = false;
  bool usable_ = false;
  Rows right_side_, solution_, correction_, own_coefficients_;
};

} // namespace nendo::deform
