#include <nendo/deform/jacobian.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <Eigen/LU>
#include <doctest/doctest.h>

#include <nendo/deform/csrbf.hpp>
#include <nendo/deform/simd.hpp>

#include "support/jacobian_at.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace jacobian_test {

using namespace nendo::deform;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using Eigen::VectorXd;
using nendo::test::jacobian_at;
using nendo::test::random_points;

TEST_SUITE("jacobian") {
  constexpr Wendland kernels[] = {Wendland::c0, Wendland::c2, Wendland::c4, Wendland::c6};
  constexpr Polynomial polynomials[] = {Polynomial::none, Polynomial::constant, Polynomial::linear};

  /// Any coefficients, not only those that solve something; some radii are equal.
  static CsrbfField any_field(std::mt19937 & random, Wendland kernel, bool with_polynomial) {
    CsrbfField field;
    field.kernel = kernel;
    field.centres = random_points(random, 12, 5.0);
    field.coefficients = random_points(random, 12, 2.0);
    field.radii = random_points(random, 12, 2.0).row(0).array() + 4.0;
    field.radii.tail(7).setConstant(5.0);
    if (with_polynomial) field.polynomial = 0.3 * random_points(random, 4, 1.0);
    return field;
  }

  /// Two hands whose fingertips are nearer to each other than the radius by far.
  static CsrbfField crowded(std::mt19937 & random, const CsrbfOptions& options) {
    Points starts = random_points(random, 10, 2.0);
    for (Eigen::Index i = 0; i < 10; ++i)
      starts.col(i) += Vector3d(i < 5 ? 0.0 : 30.0, 5.5 * static_cast<double>(i % 5), 0.0);
    CsrbfSolver solver(options);
    CsrbfField field;
    CHECK(is_solved(solver.build(starts, VectorXd::Constant(10, 80.0))));
    CHECK(is_solved(solver.solve(random_points(random, 10, 3.0), field)));
    return field;
  }

  static Vector3d moved(const CsrbfField& field, const Vector3d& x) {
    return x + field.displacement_at(x);
  }

  static Matrix3d differences(const CsrbfField& field, const Vector3d& x) {
    constexpr double step = 1e-5;
    Matrix3d jacobian;
    for (int axis = 0; axis < 3; ++axis) {
      const Vector3d by = step * Vector3d::Unit(axis);
      jacobian.col(axis) = (moved(field, x + by) - moved(field, x - by)) / (2.0 * step);
    }
    return jacobian;
  }

  /// The largest slope between pairs of points near and far, mostly round the centres.
  static double steepest_found(std::mt19937 & random, const CsrbfField& field) {
    std::uniform_real_distribution<double> unit(0.0, 1.0);
    double steepest = 0.0;
    for (int sample = 0; sample < 4000; ++sample) {
      const Eigen::Index i = sample % field.centres.cols();
      const double reach = 1.1 * field.radii[i] * std::pow(unit(random), 3.0);
      const double apart = field.radii[i] * std::pow(10.0, -5.0 * unit(random));
      const Vector3d x =
          field.centres.col(i) + reach * random_points(random, 1, 1.0).col(0).normalized();
      const Vector3d y = x + apart * random_points(random, 1, 1.0).col(0).normalized();
      steepest =
          std::max(steepest, (field.displacement_at(x) - field.displacement_at(y)).norm() / apart);
    }
    return steepest;
  }

  TEST_CASE("the Jacobian is what differences of the displacement tend to") {
    std::mt19937 random(41);
    for (const Wendland kernel : kernels)
      for (const bool with_polynomial : {false, true}) {
        const CsrbfField field = any_field(random, kernel, with_polynomial);
        const Points places = random_points(random, 100, 8.0);
        for (Eigen::Index i = 0; i < places.cols(); ++i) {
          const Vector3d x = places.col(i);
          CHECK((jacobian_at(field, x) - differences(field, x)).cwiseAbs().maxCoeff() < 1e-3);
        }
        CHECK(jacobian_at(field, field.centres.col(0)).allFinite());
      }
    CHECK(jacobian_at(CsrbfField{}, Vector3d(1, 2, 3)) == Matrix3d::Identity());
  }

  TEST_CASE("the bound of a lone centre is the steepest slope itself") {
    std::mt19937 random(42);
    constexpr double known[] = {2.0, 135.0 / 64.0, 2.4998, 2.8191};
    for (const Wendland kernel : kernels) {
      CsrbfField field = any_field(random, kernel, false);
      field.centres.conservativeResize(3, 1);
      field.coefficients.conservativeResize(3, 1);
      field.radii.conservativeResize(1);
      const double expected =
          known[static_cast<int>(kernel)] * field.coefficients.norm() / field.radii[0];
      CHECK(lipschitz_bound(field) == doctest::Approx(expected).epsilon(1e-5));
    }
  }

  TEST_CASE("no difference of displacements exceeds the bound") {
    std::mt19937 random(43);
    for (const Wendland kernel : kernels)
      for (const bool with_polynomial : {false, true})
        for (int round = 0; round < 3; ++round) {
          const CsrbfField field = any_field(random, kernel, with_polynomial);
          CHECK(steepest_found(random, field) <= lipschitz_bound(field) * (1.0 + 1e-9));
        }
  }

  TEST_CASE("where large coefficients cancel, the bound still holds and stays near the truth") {
    std::mt19937 random(44);
    for (const Wendland kernel : kernels)
      for (const Polynomial polynomial : polynomials) {
        const CsrbfField field = crowded(random, {kernel, polynomial});
        const double found = steepest_found(random, field);
        const double bound = lipschitz_bound(field);
        CHECK(found <= bound);
        if (kernel == Wendland::c0 || polynomial == Polynomial::linear) continue;
        CHECK(bound < 5.0 * found);
      }
  }

  TEST_CASE("two points that part by nothing but their distance are met by the bound") {
    // The field's slope between them is at least what they part by over their distance.
    for (const double distance : {1e-1, 1e-2, 1e-3}) {
      Points starts = Points::Zero(3, 2);
      starts(0, 1) = distance;
      Points displacements = Points::Zero(3, 2);
      displacements(1, 0) = 0.5 * distance;
      displacements(1, 1) = -0.5 * distance;
      CsrbfSolver solver({});
      CsrbfField field;
      REQUIRE(is_solved(solver.build(starts, VectorXd::Constant(2, 1.0))));
      REQUIRE(is_solved(solver.solve(displacements, field)));
      CHECK(lipschitz_bound(field) >= 1.0);
      CHECK(lipschitz_bound(field) < 1.2);
    }
  }

  TEST_CASE("supports that do not meet do not add up, those that do, do") {
    CsrbfField field;
    field.centres = Points::Zero(3, 3);
    field.centres.row(0) << 0.0, 2.1, 4.2;
    field.radii = VectorXd::Ones(3);
    field.coefficients = Points::Zero(3, 3);
    field.coefficients.row(1) << 0.1, -0.3, 0.2;
    CHECK(lipschitz_bound(field) == doctest::Approx(0.3 * 135.0 / 64.0));
    field.centres *= 0.5;
    CHECK(lipschitz_bound(field) > 0.3 * 135.0 / 64.0);
  }

  TEST_CASE("the bound is proportional to the field, and infinite if that is not finite") {
    std::mt19937 random(45);
    CsrbfField field = crowded(random, {});
    const double bound = lipschitz_bound(field);
    field.coefficients *= -2.5;
    CHECK(lipschitz_bound(field) == doctest::Approx(2.5 * bound));
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e200}) {
      field.coefficients(1, 1) = bad;
      CHECK(lipschitz_bound(field) == std::numeric_limits<double>::infinity());
    }
    CHECK(lipschitz_bound(CsrbfField{}) == 0.0);
  }

  TEST_CASE("the probe's determinant is that of the composition") {
    std::mt19937 random(46);
    CsrbfField first = any_field(random, Wendland::c2, true);
    CsrbfField second = any_field(random, Wendland::c4, false);
    first.coefficients *= 0.3;
    second.coefficients *= 0.3;
    const Points places = random_points(random, 50, 5.0);
    double least = std::numeric_limits<double>::infinity();
    for (Eigen::Index i = 0; i < places.cols(); ++i) {
      constexpr double step = 1e-5;
      Matrix3d jacobian;
      for (int axis = 0; axis < 3; ++axis) {
        const Vector3d by = step * Vector3d::Unit(axis);
        jacobian.col(axis) = (moved(second, moved(first, places.col(i) + by)) -
                              moved(second, moved(first, places.col(i) - by))) /
                             (2.0 * step);
      }
      least = std::min(least, jacobian.determinant());
    }
    DeterminantProbe probe;
    CHECK(probe.min_determinant() == 1.0);
    probe.start(places);
    CHECK(probe.min_determinant() == 1.0);
    probe.advance(first);
    probe.advance(second);
    CHECK(probe.min_determinant() == doctest::Approx(least).epsilon(1e-3));
  }

  TEST_CASE("probes of every kernel and instruction set go with the field and know its Jacobian") {
    std::mt19937 random(47);
    for (const Wendland kernel : kernels)
      for (const bool with_polynomial : {false, true}) {
        const CsrbfField field = any_field(random, kernel, with_polynomial);
        Points places = random_points(random, 61, 8.0); // not a whole number of vectors
        places.col(7) = field.centres.col(3);
        double least = std::numeric_limits<double>::infinity();
        for (const auto& place : places.colwise()) {
          const Vector3d next = moved(field, place);
          least = std::min(least, (jacobian_at(field, place) * jacobian_at(field, next))
                                      .determinant()); // det AB = det A det B
        }
        for (const auto& name : simd_names()) {
          REQUIRE(use_simd(name));
          DeterminantProbe probe;
          probe.start(places);
          probe.advance(field);
          probe.advance(field);
          CHECK(probe.min_determinant() == doctest::Approx(least).epsilon(1e-9));
        }
        use_simd("");
      }
  }

  TEST_CASE(
      "the ring of probes finds the fold of a lone finger, at just the displacement it begins") {
    for (const Wendland kernel : {Wendland::c2, Wendland::c4, Wendland::c6}) {
      const double safe = 1.0 / std::abs(wendland_slope(kernel, wendland_steepest_at(kernel)));
      for (const double part : {0.999, 1.001}) {
        CsrbfField field;
        field.kernel = kernel;
        field.centres = Vector3d(1, 2, 3);
        field.radii = VectorXd::Constant(1, 4.0);
        field.coefficients = Vector3d(0, part * safe * 4.0, 0);
        DeterminantProbe probe;
        probe.reserve(DeterminantProbe::ring_size);
        probe.start_round(field.centres, field.radii, kernel);
        probe.advance(field);
        CHECK((probe.min_determinant() > 0.0) == (part < 1.0));
        CHECK((lipschitz_bound(field) < 1.0) == (part < 1.0));
      }
    }
  }
}

} // namespace jacobian_test
