#include <nendo/deform/field.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace field_test {

using namespace nendo::deform;
using nendo::test::random_points;

namespace {

/// Functions and points of all scales and kernels; `radii` from `least` to `most`.
CsrbfField random_field(std::mt19937& random, Eigen::Index functions, double least, double most) {
  std::uniform_real_distribution<double> radius(least, most);
  CsrbfField field;
  field.kernel = static_cast<Wendland>(random() % 4);
  field.centres = random_points(random, functions, 10.0);
  field.radii.resize(functions);
  for (double& one : field.radii)
    one = radius(random);
  field.coefficients = random_points(random, functions, 2.0);
  if (random() % 2 == 0) field.polynomial.setRandom();
  return field;
}

/// Bit for bit what the definition gives, one point after the other.
bool is_as_defined(const CsrbfField& field, const Points& points) {
  Points moved;
  displace(field, points, moved);
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const Eigen::Vector3d x = points.col(i);
    const Eigen::Vector3d expected = x + field.displacement_at(x);
    for (int axis = 0; axis < 3; ++axis)
      if (moved(axis, i) != expected[axis] && !(std::isnan(moved(axis, i)) && !x.allFinite()))
        return false;
  }
  return true;
}

} // namespace

TEST_SUITE("field") {
  TEST_CASE("many functions move points as one by one they do, bit for bit") {
    std::mt19937 random(1);
    for (const Eigen::Index functions : {255, 256, 257, 900})
      for (const double least : {0.01, 0.5, 2.0, 40.0})
        for (const double most : {1.0, 1.1, 30.0}) {
          const CsrbfField field = random_field(random, functions, least, least * most);
          CHECK(is_as_defined(field, random_points(random, 300, 12.0)));
        }
  }

  TEST_CASE("points on cells' and supports' borders, and far outside, are moved as defined") {
    std::mt19937 random(2);
    CsrbfField field = random_field(random, 512, 1.0, 1.0);
    for (Eigen::Index i = 0; i < 512; ++i)
      field.centres.col(i) << static_cast<double>(i % 8), static_cast<double>(i / 8 % 8),
          static_cast<double>(i / 64);
    Points points(3, 1000 + 4);
    for (Eigen::Index i = 0; i < 1000; ++i)
      points.col(i) << static_cast<double>(i % 10) - 1.0, static_cast<double>(i / 10 % 10) - 1.0,
          static_cast<double>(i / 100) - 1.0;
    points.rightCols<4>() = Points::Constant(3, 4, 1e6);
    points(0, 1001) = -1e100;
    points(1, 1002) = 1e300;
    for (const double radius : {1.0, std::nextafter(1.0, 2.0), std::sqrt(3.0), 1e-8})
      for (const double shift : {0.0, 0.1, 1e7}) {
        field.radii.setConstant(radius);
        CsrbfField shifted = field;
        shifted.centres.array() += shift;
        CHECK(is_as_defined(shifted, points.array() + shift));
      }
  }

  TEST_CASE("points that are not finite keep to themselves") {
    std::mt19937 random(3);
    const CsrbfField field = random_field(random, 300, 2.0, 3.0);
    Points points = random_points(random, 100, 10.0);
    points(0, 0) = std::nan("");
    points(1, 50) = std::numeric_limits<double>::infinity();
    points(2, 99) = -std::numeric_limits<double>::infinity();
    CHECK(is_as_defined(field, points));
    CHECK(is_as_defined(field, Points::Constant(3, 2, std::nan(""))));
    CHECK(is_as_defined(field, Points(3, 0)));
  }

  TEST_CASE("many functions displace points in place as they do a copy") {
    std::mt19937 random(4);
    const CsrbfField field = random_field(random, 400, 1.0, 4.0);
    Points points = random_points(random, 200, 10.0);
    Points copy;
    displace(field, points, copy);
    displace(field, points, points);
    CHECK(points == copy);
  }
}

} // namespace field_test
