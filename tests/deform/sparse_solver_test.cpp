// Thousands of control vectors: the same field as a dense elimination gives, from a fraction of the
// entries.

#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "reference/bumpy_sheet.hpp"
#include "solver/solver_choices.hpp"
#include "support/fields.hpp"
#include "support/test_meshes.hpp"

namespace sparse_solver_test {

using namespace nendo::deform;
using Eigen::VectorXd;
using nendo::test::largest;
using nendo::test::random_points;
using nendo::test::values;

namespace {

/// At which so many of the sheet's points lie within reach of one.
double radius_for(double neighbours, Eigen::Index count) {
  return std::sqrt(neighbours / (3.14159 * static_cast<double>(count)));
}

} // namespace

TEST_SUITE("sparse solver") {
  TEST_CASE("sparse and dense give one field, for every kernel, polynomial and order") {
    std::mt19937 random(1);
    const Points starts = nendo::reference::bumpy_sheet(random, 150);
    const Points g = random_points(random, 150, 1.0);
    const Points points = random_points(random, 100, 1.2);
    VectorXd radii = VectorXd::Constant(150, radius_for(15.0, 150));
    for (const bool equal : {true, false}) {
      if (!equal) radii.array() *= 1.0 + 0.5 * random_points(random, 150, 1.0).row(0).array();
      for (const Wendland kernel : {Wendland::c0, Wendland::c2, Wendland::c6})
        for (const Polynomial polynomial : {Polynomial::none, Polynomial::linear}) {
          const CsrbfOptions options{kernel, polynomial, 0.01};
          CsrbfSolver dense = solver_with(options, {.storage = Storage::dense});
          CsrbfField expected;
          REQUIRE(is_solved(dense.build(starts, radii)));
          REQUIRE(is_solved(dense.solve(g, expected)));
          CHECK_FALSE(dense.effort().sparse);
          for (const auto order :
               {PointOrder::as_given, PointOrder::octree, PointOrder::minimum_degree}) {
            CsrbfSolver solver = solver_with(options, {.order = order, .storage = Storage::sparse});
            CsrbfField field;
            REQUIRE(is_solved(solver.build(starts, radii)));
            REQUIRE(is_solved(solver.solve(g, field)));
            CHECK(solver.effort().sparse);
            CHECK(field.centres == expected.centres);
            CHECK(field.radii == expected.radii);
            const Points moved = values(expected, points);
            CHECK(largest(values(field, points) - moved) < 1e-8 * largest(moved));
          }
        }
    }
  }

  // Neighbours are then looked for in another way (PointGrid).
  TEST_CASE("two crowds that are a thousand supports apart give the dense field, too") {
    std::mt19937 random(9);
    Points starts = nendo::reference::bumpy_sheet(random, 160);
    starts.rightCols(80).array() += 1000.0 * radius_for(15.0, 160);
    const Points g = random_points(random, 160, 1.0);
    const Points points = starts + random_points(random, 160, 0.1);
    const VectorXd radii = VectorXd::Constant(160, radius_for(15.0, 160));
    CsrbfField fields[2];
    for (const bool sparse : {false, true}) {
      CsrbfSolver solver = solver_with({}, {.storage = sparse ? Storage::sparse : Storage::dense});
      REQUIRE(is_solved(solver.build(starts, radii)));
      REQUIRE(is_solved(solver.solve(g, fields[sparse ? 1 : 0])));
      CHECK(solver.effort().sparse == sparse);
    }
    const Points moved = values(fields[0], points);
    CHECK(largest(values(fields[1], points) - moved) < 1e-8 * largest(moved));
  }

  TEST_CASE("an octree's order keeps the factor sparse, minimum degree more so") {
    std::mt19937 random(2);
    const Points starts = nendo::reference::bumpy_sheet(random, 2000);
    const VectorXd radii = VectorXd::Constant(2000, radius_for(9.0, 2000));
    const auto entries = [&](PointOrder order) {
      CsrbfSolver solver = solver_with({}, {.order = order});
      CHECK(is_solved(solver.build(starts, radii)));
      CHECK(solver.effort().sparse);
      CHECK(solver.effort().factor_entries >= solver.effort().matrix_entries);
      return static_cast<double>(solver.effort().factor_entries);
    };
    const double octree = entries(PointOrder::octree);
    CHECK(octree < 0.4 * entries(PointOrder::as_given));
    CHECK(entries(PointOrder::minimum_degree) < 0.7 * octree);
  }

  TEST_CASE("thousands of start points go where their control vectors say") {
    std::mt19937 random(3);
    const Points starts = nendo::reference::bumpy_sheet(random, 5000);
    const Points g = random_points(random, 5000, 1.0);
    for (const Polynomial polynomial : {Polynomial::none, Polynomial::linear}) {
      CsrbfSolver solver({.polynomial = polynomial});
      CsrbfField field;
      REQUIRE(
          is_solved(solver.build(starts, VectorXd::Constant(5000, radius_for(9.0, 5000)).eval())));
      REQUIRE(is_solved(solver.solve(g, field)));
      CHECK(solver.effort().sparse);
      CHECK(largest(values(field, starts) - g) < 1e-6);
    }
  }

  TEST_CASE("few points, and wide supports, are solved densely") {
    std::mt19937 random(4);
    const Points few = nendo::reference::bumpy_sheet(random, 40);
    CsrbfSolver solver({});
    REQUIRE(is_solved(solver.build(few, VectorXd::Constant(40, 0.1).eval())));
    CHECK_FALSE(solver.effort().sparse);
    const Points many = nendo::reference::bumpy_sheet(random, 300);
    REQUIRE(is_solved(solver.build(many, VectorXd::Constant(300, 0.1).eval())));
    CHECK(solver.effort().sparse);
    REQUIRE(is_solved(solver.build(many, VectorXd::Constant(300, 2.0).eval())));
    CHECK_FALSE(solver.effort().sparse);
    CsrbfField field;
    const Points g = random_points(random, 300, 1.0);
    REQUIRE(is_solved(solver.solve(g, field)));
    CHECK(largest(values(field, many) - g) < 1e-6);
  }

  TEST_CASE("too many points in each other's supports are refused, and the old field stays") {
    std::mt19937 random(5);
    const Eigen::Index n = CsrbfSolver::max_dense_points + 1;
    const Points starts = nendo::reference::bumpy_sheet(random, n);
    CsrbfSolver solver({});
    CsrbfField field;
    CHECK(solver.build(starts, VectorXd::Constant(n, 2.0).eval()) == FieldStatus::too_dense);
    CHECK(solver.solve(starts, field) == FieldStatus::singular);
    CHECK(field.centres.cols() == 0);
    VectorXd radii = VectorXd::Constant(n, 0.01); // each its own, as wide
    radii.tail(n - 1).setConstant(2.0);
    CHECK(solver.build(starts, radii) == FieldStatus::too_dense);
    CHECK(is_solved(solver.build(starts, VectorXd::Constant(n, 0.01).eval())));
  }

  TEST_CASE("points of all scales, and outliers, are solved or refused, never without an answer") {
    std::mt19937 random(6);
    Points starts = nendo::reference::bumpy_sheet(random, 400);
    starts.col(7) << 1e90, -1e90, 3.0;
    const Points g = random_points(random, 400, 1.0);
    CsrbfSolver solver = solver_with({}, {.storage = Storage::sparse});
    CsrbfField field;
    for (const double scale : {1e-300, 1e-100, 1.0, 1e9}) {
      const VectorXd radii = VectorXd::Constant(400, 0.1 * scale);
      if (!is_solved(solver.build(scale * starts, radii)) || !is_solved(solver.solve(g, field)))
        continue;
      CHECK(field.coefficients.allFinite());
      if (scale == 1.0) CHECK(largest(values(field, starts.leftCols(7)) - g.leftCols(7)) < 1e-6);
    }
    CHECK(field.centres.cols() == 400);
  }
}

} // namespace sparse_solver_test
