#include <nendo/deform/type1.hpp>

#include <cmath>
#include <limits>
#include <random>

#include <doctest/doctest.h>

#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

using namespace nendo::deform;
using nendo::test::random_points;

TEST_SUITE("type1") {
  const Points rest = nendo::test::sphere(20, 30, 5.0).vertices;

  /// Ten start points, the first of them on a vertex.
  static Points start_points() {
    std::mt19937 random(21);
    Points starts = random_points(random, 10, 5.0);
    starts.col(0) = rest.col(100);
    return starts;
  }

  static Points end_points(double length) {
    std::mt19937 random(22);
    return start_points() + random_points(random, 10, length);
  }

  static double largest(const Points& points) {
    return points.cwiseAbs().maxCoeff();
  }

  TEST_CASE("fingers that have not moved leave the rest shape bit for bit") {
    for (const auto polynomial : {Polynomial::none, Polynomial::constant, Polynomial::linear}) {
      Type1Deformer deformer(rest, 10, 6.0, {.polynomial = polynomial});
      Points out;
      REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
      REQUIRE(deformer.apply(end_points(1.0), out) == FieldStatus::ok);
      CHECK(out != rest);
      REQUIRE(deformer.apply(start_points(), out) == FieldStatus::ok);
      CHECK(out == rest);
    }
  }

  TEST_CASE("a vertex at a start point goes to the end point, by whatever way") {
    Type1Deformer deformer(rest, 10, 6.0, {});
    Points straight;
    Points winding;
    REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
    deformer.apply(end_points(1.0), straight);
    CHECK((straight.col(100) - end_points(1.0).col(0)).norm() < 1e-6);
    for (const double length : {9.0, 0.1, 3.0, 1.0})
      deformer.apply(end_points(length), winding);
    CHECK(winding == straight);
  }

  TEST_CASE("a commit makes the deformed shape the rest shape and the ends the starts") {
    Type1Deformer deformer(rest, 10, 6.0, {});
    Points before;
    Points after;
    REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
    deformer.apply(end_points(1.0), before);
    REQUIRE(deformer.commit(end_points(1.0)) == FieldStatus::ok);
    CHECK(deformer.rest() == before);
    REQUIRE(deformer.apply(end_points(1.0), after) == FieldStatus::ok);
    CHECK(after == before);
    REQUIRE(deformer.commit(end_points(1.0)) == FieldStatus::ok);
    CHECK(deformer.rest() == before);
  }

  TEST_CASE("before the first grab the rest shape is given, and said so") {
    Type1Deformer deformer(rest, 10, 6.0, {});
    Points out;
    CHECK(deformer.apply(end_points(1.0), out) == FieldStatus::singular);
    CHECK(out == rest);
  }

  TEST_CASE("a bad grab leaves the good one, bad ends the last good shape") {
    Type1Deformer deformer(rest, 10, 6.0, {});
    Points good;
    Points out;
    REQUIRE(deformer.grab(start_points()) == FieldStatus::ok);
    deformer.apply(end_points(1.0), good);
    for (const double bad : {std::nan(""), std::numeric_limits<double>::infinity(), 1e300}) {
      Points spoilt = start_points();
      spoilt(1, 4) = bad;
      CHECK(deformer.grab(spoilt) == FieldStatus::not_finite);
      CHECK(deformer.commit(spoilt) == FieldStatus::not_finite);
      CHECK(deformer.apply(spoilt, out) == FieldStatus::not_finite);
      CHECK(out == good);
      CHECK(deformer.apply(end_points(1.0), out) == FieldStatus::ok);
      CHECK(out == good);
      CHECK(deformer.rest() == rest);
    }
  }

  TEST_CASE("a grab with two fingers in one place works and says so") {
    Points pinched = start_points();
    pinched.col(3) = pinched.col(8);
    Type1Deformer deformer(rest, 10, 6.0, {});
    Points out;
    CHECK(deformer.grab(pinched) == FieldStatus::merged);
    CHECK(deformer.apply(end_points(1.0), out) == FieldStatus::merged);
    CHECK(out.allFinite());
    CHECK(largest(out - rest) < 100.0);
  }

  TEST_CASE("neither grab nor apply nor commit allocates") {
    Type1Deformer deformer(rest, 10, 6.0, {.polynomial = Polynomial::linear});
    const Points starts = start_points();
    const Points ends = end_points(1.0);
    Points out = rest;
    nendo::test::RestraintCounts counts;
    {
      const nendo::test::Restraint restraint;
      deformer.grab(starts);
      deformer.apply(ends, out);
      deformer.commit(ends);
      deformer.apply(starts, out);
      counts = restraint.counts();
    }
    CHECK(counts.allocations == 0);
  }
}
