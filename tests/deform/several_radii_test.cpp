// Fields of several radii: every choice has a solution, and it moves with the choice.

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include "support/fields.hpp"
#include "support/test_meshes.hpp"

namespace several_radii_test {

using namespace nendo::deform;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using nendo::test::fitted;
using nendo::test::largest;
using nendo::test::random_points;
using nendo::test::values;

namespace {

double between(std::mt19937& random, double low, double high) {
  return std::uniform_real_distribution<double>(low, high)(random);
}

/// Ten fingertips: two hands of five, a few units apart in each.
Points two_hands(std::mt19937& random) {
  Points tips = random_points(random, 10, 1.5);
  for (Eigen::Index i = 0; i < 10; ++i) {
    tips(0, i) += i < 5 ? -15.0 : 15.0;
    tips(1, i) += 5.0 * static_cast<double>(i % 5);
  }
  return tips;
}

MatrixXd wendland_matrix(Wendland kernel, const Points& at, const Points& centres,
                         const VectorXd& radii) {
  MatrixXd matrix(at.cols(), centres.cols());
  for (Eigen::Index i = 0; i < at.cols(); ++i)
    for (Eigen::Index j = 0; j < centres.cols(); ++j)
      matrix(i, j) = wendland(kernel, (at.col(i) - centres.col(j)).norm() / radii[j]);
  return matrix;
}

/// Of a field of one shared and then the own functions: what the solution makes as small as it can.
struct Energy {
  MatrixXd hessian; ///< rows: shared, then own coefficients; the energy is half of x^T H x, doubled
  MatrixXd at_starts; ///< all functions at the start points
};

Energy energy_of(const CsrbfOptions& options, const Points& starts, const Supports& supports) {
  const Eigen::Index n = starts.cols();
  const auto m = static_cast<Eigen::Index>(supports.own.size());
  Points centres(3, n + m);
  VectorXd radii(n + m);
  centres.leftCols(n) = starts;
  radii.head(n).setConstant(supports.shared[0].radius);
  for (Eigen::Index e = 0; e < m; ++e) {
    const OwnSupport& own = supports.own[static_cast<std::size_t>(e)];
    centres.col(n + e) = starts.col(own.point);
    radii[n + e] = own.support.radius;
  }
  Energy energy;
  energy.at_starts = wendland_matrix(options.kernel, starts, centres, radii);
  energy.hessian = MatrixXd::Zero(n + m, n + m);
  energy.hessian.topLeftCorner(n, n) = energy.at_starts.leftCols(n) / supports.shared[0].weight;
  for (Eigen::Index e = 0; e < m; ++e)
    energy.hessian(n + e, n + e) = 1.0 / supports.own[static_cast<std::size_t>(e)].support.weight;
  return energy;
}

/// The coefficients of least energy with these values at the start points, by Lagrange's conditions
/// and an elimination with full pivoting.
MatrixXd min_energy_coefficients(const Energy& energy, const Points& displacements) {
  const Eigen::Index functions = energy.hessian.rows();
  const Eigen::Index n = displacements.cols();
  MatrixXd system = MatrixXd::Zero(functions + n, functions + n);
  system.topLeftCorner(functions, functions) = energy.hessian;
  system.bottomLeftCorner(n, functions) = energy.at_starts;
  system.topRightCorner(functions, n) = energy.at_starts.transpose();
  MatrixXd right = MatrixXd::Zero(functions + n, 3);
  right.bottomRows(n) = displacements.transpose();
  return system.fullPivLu().solve(right).topRows(functions);
}

double energy_at(const MatrixXd& hessian, const MatrixXd& coefficients) {
  return (coefficients.transpose() * hessian * coefficients).trace();
}

} // namespace

TEST_SUITE("several radii") {
  TEST_CASE(
      "20000 random poses with radii from 5 to 80 are all solved, with bounded coefficients") {
    std::mt19937 random(1);
    CsrbfSolver solver({});
    CsrbfField field;
    int unsolved = 0;
    double worst = 0.0;
    double max_energy = 0.0;
    for (int pose = 0; pose < 20'000; ++pose) {
      const Points starts = two_hands(random);
      const Points g = random_points(random, 10, 3.0);
      VectorXd radii(10);
      for (double& radius : radii)
        radius = between(random, 5.0, 80.0);
      if (solver.build(starts, radii) != FieldStatus::ok ||
          solver.solve(g, field) != FieldStatus::ok)
        ++unsolved;
      Points reached(3, 10);
      for (Eigen::Index i = 0; i < 10; ++i)
        reached.col(i) = field.displacement_at(starts.col(i));
      worst = std::max(worst, largest(reached - g) / largest(g));
      if (pose % 10 != 0) continue;
      // The field of the common radius alone is one of those to choose from.
      Supports supports;
      assign_radii(supports, radii);
      const Energy energy = energy_of({}, starts, supports);
      MatrixXd common = MatrixXd::Zero(20, 3);
      common.topRows(10) = energy.at_starts.leftCols(10).partialPivLu().solve(g.transpose());
      max_energy = std::max(max_energy, energy_at(energy.hessian, field.coefficients.transpose()) /
                                            energy_at(energy.hessian, common));
    }
    CHECK(unsolved == 0);
    CHECK(worst < 1e-6);
    CHECK(max_energy < 1.0 + 1e-9);
  }

  TEST_CASE("the field is the one of least energy that a dense solve of its conditions gives") {
    std::mt19937 random(2);
    for (const Wendland kernel : {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6})
      for (const Eigen::Index n : {1, 10, 45}) {
        const Points starts = random_points(random, n, 10.0);
        const Points g = random_points(random, n, 3.0);
        std::vector<OwnSupport> own;
        for (Eigen::Index i = 0; i < n; ++i)
          for (int more = 0; more < 2; ++more)
            own.push_back({i, {between(random, 5.0, 20.0), between(random, 0.5, 2.0)}});
        const Supports supports = with_common(own, Support{6.0, 0.1});
        const CsrbfOptions options{kernel};
        const CsrbfField field = fitted(options, starts, supports, g);
        CHECK(field.centres.cols() == supports.functions(n));
        const Points expected =
            min_energy_coefficients(energy_of(options, starts, supports), g).transpose();
        CHECK(largest(field.coefficients - expected) < 1e-7 * largest(expected));
      }
  }

  TEST_CASE("poses where a radius for each column would be singular are solved") {
    std::mt19937 random(3);
    int found = 0;
    for (int attempt = 0; attempt < 2000 && found < 3; ++attempt) {
      const Points from = random_points(random, 10, 10.0);
      const Points to = random_points(random, 10, 10.0);
      const VectorXd radii = random_points(random, 10, 37.0).row(0).array() + 42.0;
      const auto between_them = [&](double t) -> Points { return from + t * (to - from); };
      const auto determinant = [&](double t) {
        const Points at = between_them(t);
        return wendland_matrix(Wendland::c2, at, at, radii).determinant();
      };
      if (determinant(0.0) * determinant(1.0) >= 0.0) continue;
      double low = 0.0;
      double high = 1.0;
      const double sign = determinant(0.0);
      for (int halving = 0; halving < 60; ++halving) {
        const double middle = (low + high) / 2;
        (determinant(middle) * sign > 0.0 ? low : high) = middle;
      }
      const Points starts = between_them(low);
      const Points g = random_points(random, 10, 1.0);
      const CsrbfField field = fitted({}, starts, radii, g);
      CHECK(largest(values(field, starts) - g) < 1e-6);
      CHECK(largest(values(field, random_points(random, 200, 15.0))) < 50.0);
      ++found;
    }
    CHECK(found == 3);
  }

  TEST_CASE("a mix that all share is the sum of the kernels") {
    std::mt19937 random(4);
    const Points starts = two_hands(random);
    const Points g = random_points(random, 10, 3.0);
    const Points points = random_points(random, 200, 30.0);
    const std::vector<Support> mix{{8.0, 1.0}, {25.0, 0.3}, {60.0, 0.1}};
    const CsrbfField field = fitted({}, starts, Supports{mix, {}}, g);
    CHECK(largest(values(field, starts) - g) < 1e-9);
    MatrixXd matrix = MatrixXd::Zero(10, 10);
    MatrixXd at_points = MatrixXd::Zero(200, 10);
    for (const Support& one : mix) {
      const VectorXd radii = VectorXd::Constant(10, one.radius);
      matrix += one.weight * wendland_matrix(Wendland::c2, starts, starts, radii);
      at_points += one.weight * wendland_matrix(Wendland::c2, points, starts, radii);
    }
    const Points expected =
        (at_points * matrix.fullPivLu().solve(g.transpose().eval())).transpose();
    CHECK(largest(values(field, points) - expected) < 1e-9 * largest(expected));
    // Only ratios of weights matter.
    std::vector<Support> heavier = mix;
    for (Support& one : heavier)
      one.weight *= 1000.0;
    const CsrbfField same = fitted({}, starts, Supports{heavier, {}}, g);
    CHECK(largest(values(same, points) - expected) < 1e-9 * largest(expected));
  }

  TEST_CASE("equal radii give the field of one radius, bit for bit") {
    std::mt19937 random(5);
    for (const Eigen::Index n : {10, 50}) {
      const Points starts = random_points(random, n, 10.0);
      const Points g = random_points(random, n, 3.0);
      const CsrbfField one = fitted({}, starts, Supports{{{7.0, 1.0}}, {}}, g);
      const CsrbfField each = fitted({}, starts, 7.0, g);
      CHECK(each.coefficients == one.coefficients);
      CHECK(each.radii == one.radii);
    }
  }

  TEST_CASE("the field moves evenly while radii and points move, also through equal radii") {
    std::mt19937 random(6);
    const Points starts = two_hands(random);
    const Points ends = starts + random_points(random, 10, 2.0);
    const Points g = random_points(random, 10, 3.0);
    const Points probes = random_points(random, 60, 25.0);
    const VectorXd first = random_points(random, 10, 15.0).row(0).array() + 20.0;
    const VectorXd last = 40.0 - first.array(); // equal halfway
    for (const Polynomial polynomial : {Polynomial::none, Polynomial::linear}) {
      const auto largest_step = [&](int steps) {
        CsrbfSolver solver({.polynomial = polynomial});
        CsrbfField field;
        Points before;
        double most = 0.0;
        for (int at = 0; at <= steps; ++at) {
          const double t = static_cast<double>(at) / steps;
          CHECK(is_solved(solver.build(starts + t * (ends - starts), first + t * (last - first))));
          CHECK(is_solved(solver.solve(g, field)));
          const Points now = values(field, probes);
          if (at > 0) most = std::max(most, largest(now - before));
          before = now;
        }
        return most;
      };
      const double coarse = largest_step(100);
      CHECK(largest_step(400) < 0.35 * coarse); // a jump would stay
      CHECK(coarse < 0.5);
    }
  }

  TEST_CASE("a light common radius leaves the field to the fingers' own radii") {
    std::mt19937 random(7);
    Points starts(3, 6);
    for (Eigen::Index i = 0; i < 6; ++i)
      starts.col(i) << 8.0 * static_cast<double>(i), 0.0, 0.0;
    const Points g = random_points(random, 6, 3.0);
    const VectorXd radii = VectorXd::LinSpaced(6, 6.0, 12.0);
    const Points points = random_points(random, 300, 20.0);
    const MatrixXd alone = wendland_matrix(Wendland::c2, starts, starts, radii)
                               .fullPivLu()
                               .solve(g.transpose().eval());
    const Points own = (wendland_matrix(Wendland::c2, points, starts, radii) * alone).transpose();
    std::vector<OwnSupport> each;
    for (Eigen::Index i = 0; i < 6; ++i)
      each.push_back({i, {radii[i], 1.0}});
    double farther = std::numeric_limits<double>::infinity();
    for (const double weight : {1.0, 0.1, 0.01, 1e-3}) {
      const CsrbfField field = fitted({}, starts, with_common(each, Support{6.0, weight}), g);
      const double apart = largest(values(field, points) - own);
      CHECK(apart < 0.5 * farther);
      farther = apart;
    }
    CHECK(farther < 0.01);
  }

  TEST_CASE("unusable supports are not finite, and extreme weights never give such a field") {
    std::mt19937 random(8);
    const Points starts = two_hands(random);
    const Points g = random_points(random, 10, 3.0);
    CsrbfSolver solver({});
    CHECK(solver.build(starts, Supports{{{0.0, 1.0}}, {}}) == FieldStatus::not_finite);
    CHECK(solver.build(starts, Supports{{{1.0, std::nan("")}}, {}}) == FieldStatus::not_finite);
    CHECK(solver.build(starts, Supports{{{1.0, 1.0}}, {{3, {-2.0, 1.0}}}}) ==
          FieldStatus::not_finite);
    for (const double weight : {1e-300, 1e-100, 1e-20, 1e-8, 1e8, 1e20, 1e100})
      for (const double radius : {1e-300, 1e-10, 20.0, 1e100}) {
        CsrbfField field;
        const Supports supports{{{10.0, weight}}, {{0, {radius, 1.0}}, {1, {30.0, 1.0}}}};
        if (!is_solved(solver.build(starts, supports)) || !is_solved(solver.solve(g, field)))
          continue;
        CHECK(field.coefficients.allFinite());
        CHECK(largest(values(field, starts)) < 1e3);
      }
  }
}

} // namespace several_radii_test
