#include "clay/press_problem.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <Eigen/Cholesky>
#include <Eigen/SVD>
#include <doctest/doctest.h>

#include "support/jacobian_at.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace press_problem_test {

using namespace nendo::deform;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

namespace {

std::vector<ContactPoint> random_contacts(std::mt19937& random, std::size_t count, double size) {
  const Points places = nendo::test::random_points(random, static_cast<Eigen::Index>(count), size);
  std::uniform_real_distribution<double> depth(-0.3, 1.0);
  std::vector<ContactPoint> points(count);
  for (std::size_t i = 0; i < count; ++i) {
    points[i].at = places.col(static_cast<Eigen::Index>(i));
    points[i].normal =
        (nendo::test::random_points(random, 1, 1.0).col(0) + Vector3d(0, 0, 1.2)).normalized();
    points[i].depth = depth(random);
  }
  return points;
}

double psi(double t) {
  return t < 1.0 ? std::pow(1.0 - t, 4.0) * (4.0 * t + 1.0) : 0.0;
}

MatrixXd matrix_of(const std::vector<ContactPoint>& points, double radius) {
  const auto count = static_cast<Eigen::Index>(points.size());
  MatrixXd matrix(count, count);
  for (Eigen::Index i = 0; i < count; ++i)
    for (Eigen::Index j = 0; j < count; ++j) {
      const ContactPoint& a = points[static_cast<std::size_t>(i)];
      const ContactPoint& b = points[static_cast<std::size_t>(j)];
      matrix(i, j) = psi((a.at - b.at).norm() / radius) * a.normal.dot(b.normal);
    }
  return matrix;
}

// The reference for few places: of all sets of places that may push, the one for which the
// complementarity problem holds.
VectorXd by_all_sets(const MatrixXd& matrix, const VectorXd& depths) {
  const Eigen::Index count = depths.size();
  for (unsigned set = 0; set < 1U << count; ++set) {
    std::vector<Eigen::Index> active;
    for (Eigen::Index i = 0; i < count; ++i)
      if ((set >> i & 1U) != 0) active.push_back(i);
    VectorXd all = VectorXd::Zero(count);
    if (!active.empty()) {
      const MatrixXd part = matrix(active, active);
      const VectorXd some = depths(active);
      const VectorXd found = part.ldlt().solve(some);
      for (std::size_t k = 0; k < active.size(); ++k)
        all[active[k]] = found[static_cast<Eigen::Index>(k)];
    }
    const VectorXd left = matrix * all - depths;
    if (all.minCoeff() >= -1e-12 && left.minCoeff() >= -1e-9) return all;
  }
  return VectorXd::Constant(count, -1.0);
}

VectorXd pressures_of(const PressProblem& problem, std::size_t count) {
  VectorXd all(static_cast<Eigen::Index>(count));
  for (std::size_t i = 0; i < count; ++i)
    all[static_cast<Eigen::Index>(i)] = problem.pressure(i);
  return all;
}

VectorXd depths_of(const std::vector<ContactPoint>& points) {
  VectorXd depths(static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i)
    depths[static_cast<Eigen::Index>(i)] = points[i].depth;
  return depths;
}

Vector3d field_at(const PressProblem& problem, const std::vector<ContactPoint>& points,
                  double radius, const Vector3d& place) {
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 0; i < points.size(); ++i)
    sum += psi((place - points[i].at).norm() / radius) * problem.coefficient(i);
  return sum;
}

} // namespace

TEST_SUITE("press_problem") {
  TEST_CASE("few places: the pressures are those of the only set that solves the problem") {
    std::mt19937 random(21);
    PressProblem problem(10);
    for (int trial = 0; trial < 100; ++trial) {
      const auto points = random_contacts(random, 1 + random() % 9, 1.0);
      const VectorXd wanted = by_all_sets(matrix_of(points, 1.5), depths_of(points));
      REQUIRE(wanted.minCoeff() >= -1e-12);
      problem.assign(points, 1.5);
      problem.solve_pressure(0.0);
      CHECK((matrix_of(points, 1.5) * (pressures_of(problem, points.size()) - wanted))
                .cwiseAbs()
                .maxCoeff() < 1e-4);
    }
  }

  TEST_CASE("many places: nothing is pulled, all is pushed far enough, and only where it must be") {
    std::mt19937 random(22);
    PressProblem problem(200);
    for (int trial = 0; trial < 10; ++trial) {
      const auto points = random_contacts(random, 200, 4.0);
      const MatrixXd matrix = matrix_of(points, 2.0);
      problem.assign(points, 2.0);
      problem.solve_pressure(0.0);
      const VectorXd pressure = pressures_of(problem, points.size());
      const VectorXd gap = matrix * pressure - depths_of(points);
      CHECK(pressure.minCoeff() >= 0.0);
      CHECK(gap.minCoeff() > -2e-3);
      CHECK((pressure.array() * gap.array()).abs().maxCoeff() < 2e-3);
    }
  }

  TEST_CASE("places that coincide and push against each other leave a finite compromise") {
    std::vector<ContactPoint> points(2);
    points[0].normal = Vector3d::UnitZ();
    points[1].normal = -Vector3d::UnitZ();
    points[0].depth = points[1].depth = 1.0;
    PressProblem problem(2);
    problem.assign(points, 1.0);
    problem.solve_pressure(0.0);
    CHECK(std::isfinite(problem.pressure(0)));
    CHECK(field_at(problem, points, 1.0, Vector3d::Zero()).norm() < 2.0);
  }

  TEST_CASE("under a large load, places go along, and the pressing field keeps its normals") {
    std::mt19937 random(23);
    PressProblem problem(12);
    for (int trial = 0; trial < 20; ++trial) {
      const auto points = random_contacts(random, 12, 2.0);
      problem.assign(points, 1.0);
      problem.solve_pressure(0.0);
      std::vector<Friction> frictions(points.size());
      std::array<std::uint8_t, 12> slips{};
      for (std::size_t i = 0; i < points.size(); ++i)
        frictions[i] = {nendo::test::random_points(random, 1, 0.2).col(0), 100.0, &slips[i]};
      problem.solve_friction(frictions, 0.5);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vector3d normal = points[i].normal;
        const Vector3d left = frictions[i].way - field_at(problem, points, 1.0, points[i].at);
        CHECK((left - left.dot(normal) * normal).norm() < 0.01);
        CHECK(slips[i] == 0);
        const Vector3d tangential = problem.coefficient(i) - problem.pressure(i) * normal;
        CHECK(std::abs(tangential.dot(normal)) < 1e-9);
      }
    }
  }

  TEST_CASE("no tangential force is above Coulomb's limit, and none is without a load") {
    std::mt19937 random(24);
    const auto points = random_contacts(random, 40, 2.0);
    PressProblem problem(40);
    problem.assign(points, 1.0);
    problem.solve_pressure(0.0);
    std::vector<Friction> frictions(points.size());
    std::array<std::uint8_t, 40> slips{};
    for (std::size_t i = 0; i < points.size(); ++i)
      frictions[i] = {Vector3d(1.0, 0.5, 0.0), i % 2 == 0 ? 0.1 : 0.0, &slips[i]};
    problem.solve_friction(frictions, 0.5);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vector3d tangential = problem.coefficient(i) - problem.pressure(i) * points[i].normal;
      CHECK(tangential.norm() <= 0.5 * (problem.pressure(i) + frictions[i].load) + 1e-12);
    }
  }

  TEST_CASE("slip begins at the limit and ends below 0.8 of it") {
    std::vector<ContactPoint> points(1);
    points[0].normal = Vector3d::UnitZ();
    points[0].depth = -1.0; // it touches and is loaded, but is not deep
    PressProblem problem(1);
    std::uint8_t slips = 0;
    const auto force = [&](double way) {
      problem.assign(points, 1.0);
      problem.solve_pressure(0.0);
      const std::array friction{Friction{Vector3d(way, 0.0, 0.0), 1.0, &slips}};
      problem.solve_friction(friction, 0.5);
      return problem.coefficient(0).norm();
    };
    CHECK(force(0.45) == doctest::Approx(0.45).epsilon(0.01));
    CHECK(slips == 0);
    CHECK(force(0.6) == doctest::Approx(0.4).epsilon(0.01));
    CHECK(slips == 1);
    CHECK(force(0.45) == doctest::Approx(0.4).epsilon(0.01)); // it has not stuck again
    CHECK(slips == 1);
    CHECK(force(0.35) == doctest::Approx(0.35).epsilon(0.01));
    CHECK(slips == 0);
    CHECK(force(0.45) == doctest::Approx(0.45).epsilon(0.01));
  }

  TEST_CASE("the field is nowhere steeper than the bound") {
    std::mt19937 random(25);
    PressProblem problem(30);
    for (int trial = 0; trial < 20; ++trial) {
      const auto points = random_contacts(random, 30, 2.0);
      problem.assign(points, 1.0);
      problem.solve_pressure(0.0);
      const double bound = problem.lipschitz_bound(0.0);
      CsrbfField field;
      field.centres.resize(3, 30);
      field.coefficients.resize(3, 30);
      field.radii = VectorXd::Ones(30);
      for (Eigen::Index i = 0; i < 30; ++i) {
        field.centres.col(i) = points[static_cast<std::size_t>(i)].at;
        field.coefficients.col(i) = problem.coefficient(static_cast<std::size_t>(i));
      }
      double steepest = 0.0;
      for (int probe = 0; probe < 300; ++probe) {
        const Vector3d place = nendo::test::random_points(random, 1, 2.0).col(0);
        const Eigen::Matrix3d slope =
            nendo::test::jacobian_at(field, place) - Eigen::Matrix3d::Identity();
        steepest = std::max(steepest, slope.jacobiSvd().singularValues()[0]);
      }
      CHECK(steepest <= bound);
      CHECK(bound < 8.0 * steepest);
    }
  }

  TEST_CASE("a bound that is enough is not made any less") {
    std::mt19937 random(27);
    PressProblem problem(30);
    problem.assign(random_contacts(random, 30, 2.0), 1.0);
    problem.solve_pressure(0.0);
    const double least = problem.lipschitz_bound(0.0);
    const double first = problem.lipschitz_bound(std::numeric_limits<double>::infinity());
    CHECK(least <= first);
    CHECK(problem.lipschitz_bound(first) == first);
    CHECK(problem.lipschitz_bound(0.99 * first) == least);
  }

  TEST_CASE("solving does not allocate") {
    std::mt19937 random(26);
    const auto points = random_contacts(random, 100, 2.0);
    std::array<std::uint8_t, 100> slips{};
    std::vector<Friction> frictions(100);
    for (std::size_t i = 0; i < 100; ++i)
      frictions[i] = {Vector3d::UnitX(), 0.1, &slips[i]};
    PressProblem problem(100);
    const nendo::test::Restraint restraint;
    problem.assign(points, 1.0);
    problem.solve_pressure(0.01);
    problem.solve_friction(frictions, 0.5);
    CHECK(problem.lipschitz_bound(0.0) > 0.0);
    CHECK(restraint.counts().allocations == 0);
  }
}

} // namespace press_problem_test
