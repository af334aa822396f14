#include <nendo/deform/csrbf.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/Geometry>
#include <doctest/doctest.h>

#include "support/dense_field.hpp"
#include "support/fields.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace csrbf_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using Eigen::VectorXd;
using nendo::test::dense_displacements;
using nendo::test::fitted;
using nendo::test::largest;
using nendo::test::random_points;
using nendo::test::values;

TEST_SUITE("csrbf") {
  constexpr Wendland kernels[] = {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6};
  constexpr Polynomial polynomials[] = {Polynomial::none, Polynomial::constant, Polynomial::linear};

  TEST_CASE("the field takes every start point where its control vector says") {
    std::mt19937 random(1);
    for (const Wendland kernel : kernels)
      for (const Polynomial polynomial : polynomials)
        for (const Eigen::Index n : {1, 2, 4, 5, 10, 40}) {
          const Points starts = random_points(random, n, 10.0);
          const Points displacements = random_points(random, n, 3.0);
          const CsrbfField field = fitted({kernel, polynomial}, starts, 12.0, displacements);
          CHECK(largest(values(field, starts) - displacements) < 1e-6 * largest(displacements));
        }
  }

  TEST_CASE("the field is the one that a dense solve of the paper's equations gives") {
    std::mt19937 random(2);
    for (const Wendland kernel : kernels)
      for (const Polynomial polynomial : polynomials) {
        const Points starts = random_points(random, 10, 10.0);
        const Points displacements = random_points(random, 10, 3.0);
        const Points points = random_points(random, 200, 20.0);
        const CsrbfOptions options{kernel, polynomial};
        const CsrbfField field = fitted(options, starts, 9.0, displacements);
        const Points expected = dense_displacements(options, starts, 9.0, displacements, points);
        CHECK(largest(values(field, points) - expected) < 1e-9 * largest(expected));
      }
  }

  TEST_CASE("without a polynomial nothing moves beyond the support") {
    std::mt19937 random(3);
    const Points starts = random_points(random, 10, 1.0);
    const CsrbfField field = fitted({}, starts, 2.0, random_points(random, 10, 1.0));
    Points far = random_points(random, 500, 1.0);
    for (Eigen::Index i = 0; i < far.cols(); ++i)
      far.col(i) *= 4.0 / far.col(i).norm(); // farther than sqrt(3) + 2
    Points moved;
    displace(field, far, moved);
    CHECK(moved == far);
  }

  TEST_CASE("a field of no displacements moves nothing, bit for bit") {
    std::mt19937 random(4);
    Points points = random_points(random, 50, 5.0);
    points(0, 0) = -0.0;
    for (const Polynomial polynomial : polynomials) {
      const Points starts = random_points(random, 10, 3.0);
      const CsrbfField field = fitted({Wendland::c2, polynomial}, starts, 4.0, Points::Zero(3, 10));
      Points moved;
      displace(field, points, moved);
      CHECK(moved == points);
      CHECK(std::signbit(moved(0, 0)));
    }
  }

  TEST_CASE("displacing points in place gives the same as displacing a copy") {
    std::mt19937 random(5);
    const CsrbfField field =
        fitted({}, random_points(random, 10, 3.0), 4.0, random_points(random, 10, 1.0));
    Points points = random_points(random, 50, 5.0);
    Points copy;
    displace(field, points, copy);
    displace(field, points, points);
    CHECK(points == copy);
    CHECK(field.displacement_at(copy.col(3)) == field.displacement_at(points.col(3)));
  }

  TEST_CASE("turning and shifting everything turns the field") {
    std::mt19937 random(6);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(1.1, Vector3d(1, 2, 3).normalized()).toRotationMatrix();
    const Vector3d shift(5, -7, 2);
    for (const Polynomial polynomial : polynomials) {
      const Points starts = random_points(random, 10, 5.0);
      const Points displacements = random_points(random, 10, 2.0);
      const Points points = random_points(random, 100, 9.0);
      const CsrbfOptions options{Wendland::c2, polynomial};
      const CsrbfField before = fitted(options, starts, 6.0, displacements);
      const CsrbfField after =
          fitted(options, (turn * starts).colwise() + shift, 6.0, turn * displacements);
      const Points turned_points = (turn * points).colwise() + shift;
      const Points expected = turn * values(before, points);
      CHECK(largest(values(after, turned_points) - expected) < 1e-9 * largest(expected));
    }
  }

  TEST_CASE("the field is linear in the displacements") {
    std::mt19937 random(7);
    const Points starts = random_points(random, 10, 5.0);
    const Points points = random_points(random, 100, 7.0);
    const Points g = random_points(random, 10, 2.0);
    const Points h = random_points(random, 10, 2.0);
    for (const Polynomial polynomial : polynomials) {
      const CsrbfOptions options{Wendland::c4, polynomial};
      const Points sum = 2.0 * values(fitted(options, starts, 6.0, g), points) -
                         3.0 * values(fitted(options, starts, 6.0, h), points);
      const Points direct = values(fitted(options, starts, 6.0, 2.0 * g - 3.0 * h), points);
      CHECK(largest(sum - direct) < 1e-9 * largest(direct));
    }
  }

  TEST_CASE("a constant reproduces a common shift, a linear polynomial an affine map, everywhere") {
    std::mt19937 random(8);
    const Points starts = random_points(random, 10, 5.0);
    const Points points = random_points(random, 100, 50.0);
    const Points shift = Vector3d(1, -2, 3).replicate(1, 10);
    for (const Polynomial polynomial : {Polynomial::constant, Polynomial::linear}) {
      const CsrbfField field = fitted({Wendland::c2, polynomial}, starts, 6.0, shift);
      CHECK(largest(values(field, points) - Vector3d(1, -2, 3).replicate(1, 100)) < 1e-12 * 50);
    }
    const Eigen::Matrix3d map = Eigen::Matrix3d::Random();
    const Points affine = (map * starts).colwise() + Vector3d(4, 5, 6);
    const CsrbfField field = fitted({Wendland::c2, Polynomial::linear}, starts, 6.0, affine);
    const Points expected = (map * points).colwise() + Vector3d(4, 5, 6);
    CHECK(largest(values(field, points) - expected) < 1e-11 * largest(expected));
  }

  TEST_CASE("start points in one plane, on one line or alone leave the rest of p(x) at zero") {
    std::mt19937 random(9);
    const Eigen::Matrix3d turn =
        Eigen::AngleAxisd(0.7, Vector3d(3, 1, 2).normalized()).toRotationMatrix();
    for (const Eigen::Index dimensions : {2, 1, 0}) {
      Points flat = random_points(random, dimensions == 0 ? 1 : 10, 5.0);
      flat.bottomRows(3 - dimensions).setConstant(3.0);
      const Points starts = turn * flat;
      const Points displacements = random_points(random, starts.cols(), 2.0);
      const CsrbfField field =
          fitted({Wendland::c2, Polynomial::linear}, starts, 6.0, displacements);
      CHECK(largest(values(field, starts) - displacements) < 1e-6);
      const auto gradient = field.polynomial.rightCols<3>();
      for (Eigen::Index axis = dimensions; axis < 3; ++axis)
        CHECK((gradient * turn.col(axis)).norm() < 1e-9);
    }
  }

  TEST_CASE("no control points at all give a field that moves nothing") {
    for (const Polynomial polynomial : polynomials) {
      const CsrbfField field = fitted({Wendland::c2, polynomial}, Points(3, 0), 1.0, Points(3, 0));
      CHECK(field.displacement_at({1, 2, 3}).isZero(0.0));
    }
  }

  TEST_CASE("coinciding start points share their displacements") {
    std::mt19937 random(10);
    for (const Polynomial polynomial : polynomials)
      for (const Wendland kernel : kernels) {
        Points starts = random_points(random, 10, 5.0);
        starts.col(7) = starts.col(2);
        starts.col(8) = starts.col(2);
        Points displacements = random_points(random, 10, 2.0);
        const Vector3d mean =
            (displacements.col(2) + displacements.col(7) + displacements.col(8)) / 3.0;
        const CsrbfField field =
            fitted({kernel, polynomial}, starts, 6.0, displacements, FieldStatus::merged);
        displacements.col(2) = displacements.col(7) = displacements.col(8) = mean;
        CHECK(largest(values(field, starts) - displacements) < 1e-6);
      }
    const CsrbfField all = fitted({Wendland::c2, Polynomial::linear}, Points::Ones(3, 20), 1.0,
                                  Points::Constant(3, 20, 2.0), FieldStatus::merged);
    CHECK((all.displacement_at(Vector3d::Ones()) - Vector3d::Constant(2.0)).norm() < 1e-6);
  }

  TEST_CASE("from the merge distance on, interpolation is exact") {
    Points starts = Points::Zero(3, 2);
    Points displacements(3, 2);
    displacements << 1, -1, 0, 0, 0, 0;
    starts(0, 1) = 0.0500001;
    const CsrbfOptions options{.merge_fraction = 0.05};
    CHECK(largest(values(fitted(options, starts, 1.0, displacements), starts) - displacements) <
          1e-6);
    starts(0, 1) = 0.0499;
    fitted(options, starts, 1.0, displacements, FieldStatus::merged);
  }

  TEST_CASE("huge input gives a finite field or a status, never a field that is not finite") {
    const Points starts = Points::Identity(3, 3);
    const VectorXd radii = VectorXd::Constant(3, 2.0);
    CsrbfSolver solver({.polynomial = Polynomial::linear});
    CsrbfField field;
    REQUIRE(solver.build(starts, radii) == FieldStatus::ok);
    REQUIRE(solver.solve(starts, field) == FieldStatus::ok);
    const Points before = field.coefficients;
    const double infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {1e300, -1e101, infinity, -infinity, std::nan("")}) {
      Points spoilt = starts;
      spoilt(1, 1) = bad;
      CHECK(solver.solve(spoilt, field) == FieldStatus::not_finite);
      CHECK(field.coefficients == before);
      CHECK(solver.build(spoilt, radii) == FieldStatus::not_finite);
      VectorXd bad_radii = radii;
      bad_radii[2] = bad;
      CHECK(solver.build(starts, bad_radii) == FieldStatus::not_finite);
    }
    for (const double bad : {0.0, -1.0})
      CHECK(solver.build(starts, VectorXd::Constant(3, bad)) == FieldStatus::not_finite);
    CHECK(solver.solve(1e30 * starts, field) == FieldStatus::ok);
    CHECK(field.coefficients.allFinite());
    for (const double scale : {1e-310, 1e-100, 1e-30, 1e30, 1e99}) {
      CsrbfSolver scaled({.polynomial = Polynomial::linear});
      CsrbfField result;
      if (is_solved(scaled.build(scale * starts, VectorXd::Constant(3, scale))) &&
          is_solved(scaled.solve(1e99 * starts, result))) {
        CHECK(result.coefficients.allFinite());
        CHECK(result.polynomial.allFinite());
        CHECK(result.displacement_at(Vector3d::Constant(1e99)).allFinite());
      }
    }
  }

  TEST_CASE("once called with a size, neither building nor solving allocates") {
    std::mt19937 random(14);
    for (const Polynomial polynomial : polynomials)
      for (const Eigen::Index n : {1, 10, 17, 32, 60, 100})
        for (const bool equal : {true, false}) {
          CsrbfSolver solver({Wendland::c2, polynomial, 0.05});
          CsrbfField field;
          const Points starts = random_points(random, n, 5.0);
          const Points other = random_points(random, n, 5.0);
          const Points g = random_points(random, n, 1.0);
          const VectorXd radii = VectorXd::LinSpaced(n, 5.0, equal ? 5.0 : 6.0);
          CHECK(is_solved(solver.build(starts, radii)));
          CHECK(is_solved(solver.solve(g, field)));
          bool solved = true;
          nendo::test::RestraintCounts counts;
          {
            const nendo::test::Restraint restraint;
            solved = solved && is_solved(solver.build(other, radii));
            solved = solved && is_solved(solver.solve(g, field));
            counts = restraint.counts();
          }
          CHECK(solved);
          CHECK(counts.allocations == 0);
          CHECK(counts.locks == 0);
        }
  }

  TEST_CASE("polynomials and statuses have names") {
    for (const Polynomial polynomial : polynomials)
      CHECK(polynomial_named(name_of(polynomial)) == polynomial);
    CHECK_FALSE(polynomial_named("cubic"));
    for (const auto status : {FieldStatus::ok, FieldStatus::merged, FieldStatus::singular,
                              FieldStatus::too_dense, FieldStatus::not_finite})
      CHECK_FALSE(describe(status).empty());
  }
}

} // namespace csrbf_test
