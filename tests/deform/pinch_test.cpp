// Start points that come together, pass through each other and part: what they and the
// surroundings feel must neither jump nor grow without bound.

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "solver/solver_choices.hpp"
#include "support/fields.hpp"
#include "support/test_meshes.hpp"

namespace pinch_test {

using namespace nendo::deform;
using Eigen::VectorXd;
using nendo::test::largest;
using nendo::test::random_points;
using nendo::test::values;

namespace {

constexpr double merge_fraction = 0.05;
/// What the header promises of fields of equal and of several radii.
constexpr double most = 0.25 / merge_fraction;
constexpr double max_of_several = 1.25 / merge_fraction;

/// `crowd` start points that shrink to one and come out on the other side, among others that stay.
struct Sweep {
  Sweep(Eigen::Index crowd, Eigen::Index others, unsigned seed) : random(seed) {
    offsets = random_points(random, crowd, 0.2);
    if (crowd == 2) offsets.col(1) = -offsets.col(0);
    place = Eigen::Vector3d(0.1, 0.0, -0.1);
    stay.resize(3, others);
    for (Eigen::Index i = 0; i < others; ++i)
      stay.col(i) = random_points(random, 1, 1.5).col(0) + Eigen::Vector3d(2.0, 0.0, 0.0);
    g = random_points(random, crowd + others, 1.0);
    probes.resize(3, 100);
    probes << random_points(random, 60, 1.0), random_points(random, 40, 0.1).colwise() + place;
  }

  Points starts_at(double scale) const {
    Points starts(3, offsets.cols() + stay.cols());
    starts << (scale * offsets).colwise() + place, stay;
    return starts;
  }

  /// Of builds at even steps from 1 to -1: the largest value, and the largest change in a step.
  template <class Of>
  std::pair<double, double> run(CsrbfSolver& solver, const Of& of, int steps) const {
    double bound = 0.0;
    double jump = 0.0;
    Points before;
    for (int at = 0; at <= steps; ++at) {
      const Points now = field_at(solver, of, 1.0 - 2.0 * at / steps);
      bound = std::max(bound, largest(now));
      if (at > 0) jump = std::max(jump, largest(now - before));
      before = now;
    }
    return {bound, jump};
  }

  template <class Of>
  Points field_at(CsrbfSolver& solver, const Of& of, double scale) const {
    CsrbfField field;
    CHECK(is_solved(solver.build(starts_at(scale), of)));
    CHECK(is_solved(solver.solve(g, field)));
    return values(field, probes);
  }

  std::mt19937 random;
  Points offsets, stay, g, probes;
  Eigen::Vector3d place;
};

/// The law: four times as many steps make a fourth of the change in each, no more than half; and
/// the field stays below so many times the displacements, which are at most 1.
template <class Of>
void check_sweep(const Sweep& sweep, CsrbfSolver solver, const Of& of, int steps,
                 double bound_allowed) {
  const auto [bound, coarse] = sweep.run(solver, of, steps);
  const double fine = sweep.run(solver, of, 4 * steps).second;
  CHECK(bound < bound_allowed);
  CHECK(fine < 0.5 * coarse);
}

VectorXd unequal_radii(Eigen::Index n) {
  return VectorXd::LinSpaced(n, 1.0, 2.5);
}

} // namespace

TEST_SUITE("pinch") {
  constexpr Wendland kernels[] = {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6};

  TEST_CASE("two fingertips pass through each other") {
    for (const Wendland kernel : kernels) {
      CAPTURE(static_cast<int>(kernel));
      const Sweep sweep(2, 3, 1);
      for (const Storage storage : {Storage::by_size, Storage::sparse}) {
        const CsrbfOptions options{.kernel = kernel, .merge_fraction = merge_fraction};
        const auto solver = [&] { return solver_with(options, {.storage = storage}); };
        check_sweep(sweep, solver(), VectorXd::Ones(5).eval(), 150, most);
        check_sweep(sweep, solver(), unequal_radii(5), 150, max_of_several);
        check_sweep(sweep, solver(), Supports{{{1.0, 1.0}, {3.0, 0.2}}, {}}, 150, most);
      }
    }
  }

  TEST_CASE("five fingertips meet in one point") {
    const Sweep sweep(5, 5, 2);
    for (const Storage storage : {Storage::by_size, Storage::sparse})
      for (const Polynomial polynomial : {Polynomial::none, Polynomial::linear}) {
        const CsrbfOptions options{.polynomial = polynomial, .merge_fraction = merge_fraction};
        const auto solver = [&] { return solver_with(options, {.storage = storage}); };
        check_sweep(sweep, solver(), VectorXd::Ones(10).eval(), 200, 2.0 * most);
        check_sweep(sweep, solver(), unequal_radii(10), 200, max_of_several);
      }
  }

  TEST_CASE("a crowd of start points meets in one") {
    const Sweep hundred(100, 10, 3);
    const Sweep thirty(30, 10, 3);
    for (const Storage storage : {Storage::dense, Storage::sparse}) {
      const CsrbfOptions options{.merge_fraction = merge_fraction};
      const auto solver = [&] { return solver_with(options, {.storage = storage}); };
      check_sweep(hundred, solver(), VectorXd::Ones(110).eval(), 40, most);
      check_sweep(thirty, solver(), unequal_radii(40), 120, max_of_several);
    }
  }

  TEST_CASE("the nearer they are, the nearer is the field to that of coinciding points") {
    for (const Wendland kernel : kernels)
      for (const bool equal : {true, false}) {
        CAPTURE(static_cast<int>(kernel));
        const Sweep sweep(2, 3, 4);
        const VectorXd radii = equal ? VectorXd::Ones(5).eval() : unequal_radii(5);
        CsrbfSolver solver({.kernel = kernel, .merge_fraction = merge_fraction});
        const Points limit = sweep.field_at(solver, radii, 0.0);
        for (int halving = 4; halving < 50; ++halving) {
          const double scale = std::ldexp(1.0, -halving);
          CHECK(largest(sweep.field_at(solver, radii, scale) - limit) < 100.0 * scale + 1e-9);
        }
      }
  }

  TEST_CASE("where they coincide, all move by the mean, whatever the radii") {
    std::mt19937 random(5);
    for (const Storage storage : {Storage::by_size, Storage::sparse})
      for (const Eigen::Index crowd : {2, 5, 100}) {
        const Sweep sweep(crowd, 6, 6);
        const Points starts = sweep.starts_at(0.0);
        Points expected = sweep.g;
        expected.leftCols(crowd).colwise() = sweep.g.leftCols(crowd).rowwise().mean().eval();
        for (const bool equal : {true, false}) {
          const VectorXd radii =
              equal ? VectorXd::Ones(crowd + 6).eval() : unequal_radii(crowd + 6);
          CsrbfSolver solver = solver_with({}, {.storage = storage});
          CsrbfField field;
          CHECK(solver.build(starts, radii) == FieldStatus::merged);
          CHECK(solver.solve(sweep.g, field) == FieldStatus::merged);
          CHECK(largest(values(field, starts) - expected) < 1e-6);
        }
      }
  }
}

} // namespace pinch_test
