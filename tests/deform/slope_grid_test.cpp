#include "clay/press_problem.hpp"

#include <algorithm>
#include <random>

#include <Eigen/SVD>
#include <doctest/doctest.h>

#include <nendo/deform/field.hpp>
#include <nendo/deform/wendland.hpp>

#include "support/jacobian_at.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace slope_grid_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using nendo::test::random_points;

namespace {

double bound_of(SlopeGrid& grid, const CsrbfField& field) {
  grid.begin(field.centres.rowwise().minCoeff(), field.centres.rowwise().maxCoeff(),
             field.radii[0]);
  for (Eigen::Index i = 0; i < field.centres.cols(); ++i)
    grid.add(field.centres.col(i), field.coefficients.col(i).norm());
  return grid.lipschitz_bound();
}

CsrbfField field_of(const Points& centres, const Points& coefficients, double radius) {
  CsrbfField field;
  field.centres = centres;
  field.coefficients = coefficients;
  field.radii = Eigen::VectorXd::Constant(centres.cols(), radius);
  return field;
}

double slope_at(const CsrbfField& field, const Vector3d& place) {
  const Eigen::Matrix3d slope =
      nendo::test::jacobian_at(field, place) - Eigen::Matrix3d::Identity();
  return slope.jacobiSvd().singularValues()[0];
}

/// Near centres, and a quarter of a radius away from them, where one function is the steepest.
double steepest_found(std::mt19937& random, const CsrbfField& field) {
  double steepest = 0.0;
  for (Eigen::Index i = 0; i < field.centres.cols(); ++i)
    for (const double way : {0.05, 0.25, 0.5, 0.9}) {
      const Vector3d direction = random_points(random, 1, 2.0).col(0).normalized();
      const Vector3d place = field.centres.col(i) + way * field.radii[0] * direction;
      steepest = std::max(steepest, slope_at(field, place));
    }
  return steepest;
}

/// A sheet that is pushed down everywhere alike, with three centres a radius of 1.
CsrbfField sheet_of(int side) {
  Points centres(3, side * side);
  for (int at = 0; at < side * side; ++at)
    centres.col(at) << (at % side) / 3.0, (at / side) / 3.0, 0.0;
  Points coefficients = Points::Zero(3, centres.cols());
  coefficients.row(2).setConstant(-0.02);
  return field_of(centres, coefficients, 1.0);
}

double bound_by_norm(const CsrbfField& field) {
  Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
  for (Eigen::Index i = 0; i < field.centres.cols(); ++i)
    for (Eigen::Index j = 0; j < field.centres.cols(); ++j) {
      const double apart = (field.centres.col(i) - field.centres.col(j)).norm();
      gram += wendland(Wendland::c2, apart / field.radii[i]) * field.coefficients.col(i) *
              field.coefficients.col(j).transpose();
    }
  return bound_of_gram(gram, field.radii[0]);
}

} // namespace

TEST_SUITE("slope grid") {
  TEST_CASE("no field is steeper than its bound, however small or wide it is") {
    std::mt19937 random(61);
    SlopeGrid grid;
    for (const double radius : {0.01, 1.0, 30.0})
      for (const double size : {0.1, 2.0, 12.0, 60.0}) // in radii; wide ones have larger cells
        for (int trial = 0; trial < 10; ++trial) {
          const Points centres = random_points(random, 40, size * radius);
          const Points coefficients = random_points(random, 40, 0.3 * radius);
          const CsrbfField field = field_of(centres, coefficients, radius);
          CHECK(steepest_found(random, field) <= bound_of(grid, field));
        }
  }

  TEST_CASE("one function is as steep as its slope is") {
    SlopeGrid grid;
    const CsrbfField field = field_of(Vector3d(3, 4, 5), Vector3d(0, 0.6, 0.8), 2.0);
    CHECK(bound_of(grid, field) == doctest::Approx(135.0 / 64.0 / 2.0).epsilon(1e-3));
  }

  TEST_CASE("the bound of a sheet does not grow with the sheet, as that by the norm does") {
    SlopeGrid grid;
    std::mt19937 random(62);
    const CsrbfField small = sheet_of(8), large = sheet_of(16);
    CHECK(bound_of(grid, large) < 1.05 * bound_of(grid, small));
    CHECK(bound_of(grid, large) > steepest_found(random, large));
    CHECK(bound_by_norm(large) > 1.5 * bound_by_norm(small));
    CHECK(bound_of(grid, large) < 0.5 * bound_by_norm(large));
  }

  TEST_CASE("sheets that are far apart are no steeper than one") {
    SlopeGrid grid;
    const CsrbfField one = sheet_of(6);
    for (int axis = 0; axis < 3; ++axis) {
      Points centres(3, 72), coefficients(3, 72);
      centres << one.centres, one.centres.colwise() + 4.5 * Vector3d::Unit(axis);
      coefficients << one.coefficients, one.coefficients;
      CHECK(bound_of(grid, field_of(centres, coefficients, 1.0)) ==
            doctest::Approx(bound_of(grid, one)).epsilon(0.1));
    }
  }

  TEST_CASE("a bound takes no memory") {
    SlopeGrid grid;
    const CsrbfField field = sheet_of(10);
    const Vector3d low = field.centres.rowwise().minCoeff();
    const Vector3d high = field.centres.rowwise().maxCoeff();
    const nendo::test::Restraint restraint;
    grid.begin(low, high, 1.0);
    for (Eigen::Index i = 0; i < field.centres.cols(); ++i)
      grid.add(field.centres.col(i), 0.02);
    CHECK(grid.lipschitz_bound() > 0.0);
    CHECK(restraint.counts().allocations == 0);
  }
}

} // namespace slope_grid_test
