#include "deformer/min_gap.hpp"

#include <algorithm>
#include <cmath>
#include <random>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace min_gap_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using Eigen::VectorXd;
using nendo::test::random_points;

TEST_SUITE("min_gap") {
  constexpr double fraction = 0.05;
  constexpr double radius = 10.0;

  static MinGap begun(const Points& starts) {
    MinGap gaps(fraction);
    gaps.reserve(starts.cols());
    gaps.begin(starts, VectorXd::Constant(starts.cols(), radius));
    return gaps;
  }

  static Points pair(const Vector3d& first, const Vector3d& second) {
    Points points(3, 2);
    points << first, second;
    return points;
  }

  /// Where the walls that the way puts up let it end.
  static Points end_of(MinGap & gaps, const Points& from, const Points& to) {
    Points allowed = to;
    const double part = gaps.free_part(from, to);
    if (part < 1.0) CHECK(gaps.hold(from, to, part));
    gaps.project(to, allowed);
    return allowed;
  }

  TEST_CASE("points that run into each other stop at the gap, each displaced by the same amount") {
    const Points from = pair({-2, 0, 0}, {2, 0, 0});
    MinGap gaps = begun(from);
    const Points to = pair({3, 0, 0}, {-1, 0, 0});
    CHECK(gaps.free_part(from, to) == doctest::Approx((4.0 - fraction * radius) / 8.0));
    const Points end = end_of(gaps, from, to);
    CHECK((end.col(1) - end.col(0) - Vector3d(0.5, 0, 0)).norm() < 1e-9);
    CHECK(((end - to).col(0) + (end - to).col(1)).norm() < 1e-9);
    REQUIRE(gaps.walls().size() == 1);
    CHECK(gaps.walls()[0].push == doctest::Approx((end - to).col(0).norm()));
  }

  TEST_CASE("a held pair keeps its sliding along the wall") {
    const Points from = pair({-2, 0, 0}, {2, 0, 0});
    MinGap gaps = begun(from);
    end_of(gaps, from, pair({3, 0, 0}, {-1, 0, 0}));
    Points allowed;
    gaps.project(pair({3, 7, 1}, {-1, -5, 2}), allowed);
    CHECK((allowed.bottomRows<2>() - pair({3, 7, 1}, {-1, -5, 2}).bottomRows<2>()).norm() < 1e-9);
    CHECK(allowed(0, 1) - allowed(0, 0) == doctest::Approx(0.5));
  }

  TEST_CASE("ways that stay apart are free") {
    std::mt19937 random(51);
    const Points from = random_points(random, 10, 50.0);
    MinGap gaps = begun(from);
    for (const Points& to :
         {from, Points(2.0 * from), Points(from.colwise() + Vector3d(9, 9, 9))}) {
      CHECK(gaps.free_part(from, to) == 1.0);
      CHECK_FALSE(gaps.hold(from, to, 1.0));
      CHECK(end_of(gaps, from, to) == to);
    }
  }

  TEST_CASE("the part that is free is the first at which a pair is at its gap") {
    std::mt19937 random(52);
    int met = 0;
    for (int round = 0; round < 300; ++round) {
      const Points from = random_points(random, 5, 2.0);
      const Points to = random_points(random, 5, 2.0);
      const MinGap gaps = begun(from);
      const double free = gaps.free_part(from, to);
      if (free < 1.0) ++met;
      for (double part = 0.0; part < free; part += 0.01) {
        const Points places = (1.0 - part) * from + part * to;
        for (Eigen::Index i = 0; i < 5; ++i)
          for (Eigen::Index j = 0; j < i; ++j) {
            const double gap =
                std::min(fraction * radius, 0.5 * (from.col(i) - from.col(j)).norm());
            CHECK((places.col(i) - places.col(j)).norm() > gap * (1.0 - 1e-9));
          }
      }
    }
    CHECK(met > 30);
  }

  TEST_CASE("where many are held, the ends are the nearest that all walls allow") {
    // The conditions of Karush, Kuhn and Tucker, checked one by one.
    std::mt19937 random(53);
    for (int round = 0; round < 20; ++round) {
      const Points from = random_points(random, 8, 2.0);
      MinGap gaps = begun(from);
      for (int turn = 0; turn < 6; ++turn) {
        const Points to = random_points(random, 8, 2.0);
        gaps.hold(from, to, 1.0);
      }
      const Points wanted = random_points(random, 8, 2.0);
      Points allowed;
      gaps.project(wanted, allowed);
      Points forces = wanted;
      for (const HeldPair& wall : gaps.walls()) {
        const double apart = wall.normal.dot(allowed.col(wall.first) - allowed.col(wall.second));
        CHECK(apart > wall.gap - 1e-3);
        CHECK(wall.push >= 0.0);
        CHECK(wall.push * (apart - wall.gap) < 1e-3);
        forces.col(wall.first) += wall.push * wall.normal;
        forces.col(wall.second) -= wall.push * wall.normal;
      }
      CHECK((forces - allowed).cwiseAbs().maxCoeff() < 1e-9);
    }
  }

  TEST_CASE("a wall begins with nothing where a way only grazes the gap") {
    const Points from = pair({-2, 0, 0}, {2, 0, 0});
    Points last;
    double largest_change = 0.0;
    constexpr double step = 1e-4;
    bool free = false;
    bool held = false;
    for (double miss = 1.1; miss > 0.8; miss -= step) {
      MinGap gaps = begun(from);
      const Points to = pair({3, 0, 0}, {-3, 1.3 * miss, 0});
      const Points end = end_of(gaps, from, to);
      (gaps.walls().empty() ? free : held) = true;
      if (last.cols() > 0) largest_change = std::max(largest_change, (end - last).norm());
      last = end;
    }
    CHECK(free);
    CHECK(held);
    // The slope with which the wall turns: the length of the way over the gap.
    CHECK(largest_change < 40.0 * step);
  }

  TEST_CASE("a pair is released when it is wanted apart, and not before") {
    const Points from = pair({-2, 0, 0}, {2, 0, 0});
    MinGap gaps = begun(from);
    end_of(gaps, from, pair({3, 0, 0}, {-1, 0, 0}));
    gaps.release(pair({0.2, 0, 0}, {0.3, 0, 0}));
    CHECK(gaps.walls().size() == 1);
    gaps.release(pair({0, 0, 0}, {0.6, 0, 0}));
    CHECK(gaps.walls().empty());
  }

  TEST_CASE(
      "points that begin nearer than the gap have half their distance, and if together, none") {
    for (const double distance : {0.1, 0.0}) {
      const Points from = pair({0, 0, 0}, {distance, 0, 0});
      MinGap gaps = begun(from);
      const Points end = end_of(gaps, from, pair({1, 0, 0}, {-1, 0, 0}));
      if (distance == 0.0)
        CHECK(end == pair({1, 0, 0}, {-1, 0, 0}));
      else
        CHECK(end(0, 1) - end(0, 0) == doctest::Approx(0.5 * distance));
    }
  }

  TEST_CASE("absurd distances overflow nowhere") {
    for (const double size : {1e99, 1e-160}) {
      const Points from = pair({-size, 0, 0}, {size, 0, 0});
      const Points to = -from;
      MinGap gaps = begun(from);
      const double part = gaps.free_part(from, to);
      CHECK((part >= 0.0 && part <= 1.0));
      gaps.hold(from, to, part);
      Points allowed;
      gaps.project(to, allowed);
      CHECK(allowed.allFinite());
    }
  }
}

} // namespace min_gap_test
