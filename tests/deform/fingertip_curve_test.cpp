#include "deformer/fingertip_curve.hpp"

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "support/test_meshes.hpp"

namespace fingertip_curve_test {

using namespace nendo::deform;
using Eigen::Vector3d;

namespace {

Points lone(double x, double y = 0.0, double z = 0.0) {
  return Vector3d(x, y, z);
}

std::vector<Points> cuts_of(FingertipCurve& curve) {
  std::vector<Points> cuts;
  Points cut = curve.end();
  while (curve.next_cut(cut))
    cuts.push_back(cut);
  return cuts;
}

/// Cuts of a circle of radius 1 about the origin, sampled so many times a turn.
std::vector<Points> circle(double piece_length, int samples, int turns) {
  FingertipCurve curve(1, piece_length);
  curve.begin(lone(1.0));
  std::vector<Points> all;
  for (int k = 1; k <= samples * turns; ++k) {
    const double angle = 2.0 * std::numbers::pi * k / samples;
    curve.extend(lone(std::cos(angle), std::sin(angle)));
    for (const Points& cut : cuts_of(curve))
      all.push_back(cut);
  }
  return all;
}

} // namespace

TEST_SUITE("fingertip_curve") {
  TEST_CASE("an even motion along a line is cut into pieces of the length, on the line") {
    FingertipCurve curve(2, 0.1);
    Points tips(3, 2);
    tips << 0, 1, 0, 0, 0, 0;
    curve.begin(tips);
    std::vector<Points> all;
    for (int k = 1; k <= 30; ++k) {
      tips(0, 0) = 0.07 * k;
      tips(1, 1) = 0.05 * k;
      curve.extend(tips);
      for (const Points& cut : cuts_of(curve))
        all.push_back(cut);
    }
    REQUIRE(all.size() == 21); // the farther goes 2.1
    for (std::size_t k = 0; k < all.size(); ++k) {
      const double way = 0.1 * static_cast<double>(k + 1);
      CHECK((all[k].col(0) - Vector3d(way, 0, 0)).norm() < 1e-9);
      CHECK((all[k].col(1) - Vector3d(1, way * 5 / 7, 0)).norm() < 1e-9);
    }
  }

  TEST_CASE("cuts are a constant arc length apart, also across samples") {
    const auto cuts = circle(0.05, 20, 2);
    CHECK(cuts.size() == doctest::Approx(4.0 * std::numbers::pi / 0.05).epsilon(0.02));
    for (std::size_t k = 1; k < cuts.size(); ++k)
      CHECK((cuts[k] - cuts[k - 1]).norm() == doctest::Approx(0.05).epsilon(0.01));
  }

  TEST_CASE("the curve is far nearer to a circle than chords are, and has no corners") {
    const auto cuts = circle(0.02, 12, 3);
    const double sagitta = 1.0 - std::cos(std::numbers::pi / 12.0);
    const double corner = 2.0 * std::numbers::pi / 12.0; // where two chords meet
    double off = 0.0;
    double turn = 0.0;
    for (std::size_t k = 100; k < cuts.size(); ++k) { // its first chord is straight
      off = std::max(off, std::abs(cuts[k].norm() - 1.0));
      const Vector3d before = (cuts[k - 1] - cuts[k - 2]).normalized();
      const Vector3d after = (cuts[k] - cuts[k - 1]).normalized();
      turn = std::max(turn, std::acos(std::min(1.0, before.dot(after))));
    }
    CHECK(off < 0.25 * sagitta);
    CHECK(turn < 0.2 * corner);
  }

  TEST_CASE("trembling makes no way, and the end is met exactly") {
    FingertipCurve curve(1, 0.1);
    curve.begin(lone(1.0));
    for (int k = 0; k < 1000; ++k)
      curve.extend(lone(k % 2 == 0 ? 1.049 : 0.951));
    CHECK(cuts_of(curve).empty());
    curve.end_at(lone(1.049));
    const auto cuts = cuts_of(curve);
    REQUIRE(cuts.size() == 1);
    CHECK(cuts.front() == lone(1.049));
    curve.end_at(lone(1.049));
    CHECK(cuts_of(curve).empty());
  }

  TEST_CASE("a fingertip that rests is not moved by a bit while another goes a long way") {
    FingertipCurve curve(2, 0.1);
    Points tips(3, 2);
    tips << 0, 7, 0, 7, 0, 7;
    curve.begin(tips);
    std::size_t pieces = 0;
    for (int k = 1; k < 50; ++k) {
      tips(0, 0) = 0.08 * k;
      tips(2, 1) = 7.0 + (k % 3) * 0.01;
      curve.extend(tips);
      for (const Points& cut : cuts_of(curve)) {
        ++pieces;
        CHECK(cut.col(1) == Vector3d(7, 7, 7));
      }
    }
    CHECK(pieces > 30);
  }

  TEST_CASE("a fingertip that turns back, or stops, does not go beyond its samples") {
    FingertipCurve curve(1, 0.05);
    curve.begin(lone(0.0));
    double last = 0.0;
    for (const double x : {1.0, 2.0, 0.5, 0.4, 0.3, 3.0, 3.06, 3.0}) {
      curve.extend(lone(x));
      for (const Points& cut : cuts_of(curve)) {
        CHECK(cut(0, 0) >= std::min(x, last) - 0.051); // a piece may have waited
        CHECK(cut(0, 0) <= std::max(x, last) + 1e-12);
      }
      last = x;
    }
  }

  TEST_CASE("a jump takes a bounded number of longer pieces, and arrives") {
    FingertipCurve curve(1, 1e-6);
    curve.begin(lone(0.0));
    for (const double x : {3.0, -1e30, 1e30, 1e-300}) {
      curve.extend(lone(x));
      const auto cuts = cuts_of(curve);
      CHECK(cuts.size() == FingertipCurve::max_pieces);
      CHECK(cuts.back() == lone(x));
    }
    curve.end_at(lone(1e-310)); // nearer than a distance can express
    CHECK(cuts_of(curve).empty());
  }

  TEST_CASE("of any way, however wild, cuts are finite, few a sample, and not far from it") {
    std::mt19937 random(7);
    std::normal_distribution<double> normal;
    for (const double piece : {0.01, 0.3, 5.0}) {
      FingertipCurve curve(10, piece);
      Points tips = nendo::test::random_points(random, 10, 1.0);
      curve.begin(tips);
      for (int k = 0; k < 200; ++k) {
        const Points last = curve.end();
        for (double& coordinate : tips.reshaped())
          coordinate += std::pow(10.0, 2.0 * normal(random) - 3.0) * normal(random);
        k % 20 == 19 ? curve.end_at(tips) : curve.extend(tips);
        const double step = (curve.end() - last).colwise().norm().maxCoeff();
        const auto cuts = cuts_of(curve);
        CHECK(cuts.size() <= FingertipCurve::max_pieces);
        for (const Points& cut : cuts)
          CHECK((cut - last).colwise().norm().maxCoeff() <= 1.5 * step + piece);
        if (k % 20 == 19) CHECK((cuts.empty() || cuts.back() == tips));
      }
    }
  }
}

} // namespace fingertip_curve_test
