#include <nendo/deform/type2.hpp>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include <doctest/doctest.h>

#include "deformer/fingertip_curve.hpp"
#include "nendo/deform/type1.hpp"
#include "support/fields.hpp"
#include "support/restraint.hpp"
#include "support/test_meshes.hpp"

namespace type2_test {

using namespace nendo::deform;
using Eigen::Vector3d;
using nendo::test::largest;
using nendo::test::random_points;

TEST_SUITE("type2") {
  const Points clay = nendo::test::sphere(20, 30, 5.0).vertices;

  static Points start_points() {
    std::mt19937 random(31);
    Points starts = random_points(random, 10, 5.0);
    starts.col(0) = clay.col(100);
    return starts;
  }

  static Points shifted(const Vector3d& by) {
    return start_points().colwise() + by;
  }

  static Points shape_of(const Type2Deformer& deformer) {
    Points shape;
    deformer.layout().unpack(deformer.shape(), shape);
    return shape;
  }

  /// What a shape in float may be off after some pieces in a model of this size.
  constexpr double float_gap = 1e-5;

  /// A straight stroke in so many pieces.
  static Points stroked(const Points& ends, int pieces) {
    const double length = (ends - start_points()).colwise().norm().maxCoeff();
    Type2Deformer deformer(clay, 10, length / pieces * (1.0 + 1e-9), {one_radius(6.0)});
    deformer.begin(start_points());
    int applied = 0;
    for (int part = 1; part <= 16; ++part)
      applied +=
          deformer.stroke_to(start_points() + (ends - start_points()) * (part / 16.0)).pieces;
    applied += deformer.end_at(ends).pieces;
    CHECK(applied >= pieces);
    CHECK(applied <= pieces + 1); // slower fingertips may be a quarter of a piece behind
    return shape_of(deformer);
  }

  TEST_CASE("a stroke of no length leaves the shape alone") {
    Type2Deformer deformer(clay, 10, 0.1, {one_radius(6.0)});
    deformer.begin(start_points());
    CHECK(deformer.stroke_to(start_points()).pieces == 0);
    CHECK(deformer.end_at(start_points()).pieces == 0);
    CHECK(shape_of(deformer) == clay);
  }

  TEST_CASE("a vertex under a fingertip is carried along any curve to its end") {
    Type2Deformer deformer(clay, 10, 0.1, {one_radius(6.0)});
    deformer.begin(start_points());
    for (int sample = 1; sample <= 100; ++sample) {
      const double turn = 0.1 * sample;
      const Points tips = shifted({std::sin(turn), 1.0 - std::cos(turn), 0.1 * turn});
      CHECK(is_solved(deformer.stroke_to(tips).status));
    }
    const Points end = shifted({std::sin(10.0), 1.0 - std::cos(10.0), 1.0});
    CHECK((shape_of(deformer).col(100) - end.col(0)).norm() < 0.15);
    deformer.end_at(end);
    CHECK((shape_of(deformer).col(100) - end.col(0)).norm() < float_gap);
  }

  TEST_CASE("the fastest fingertip sets the cuts, what is left waits") {
    Type2Deformer deformer(clay, 10, 1.0, {one_radius(6.0)});
    deformer.begin(start_points());
    Points tips = start_points();
    tips(0, 0) += 2.5;
    tips(1, 1) += 0.5;
    CHECK(deformer.stroke_to(tips).pieces == 2);
    CHECK((shape_of(deformer).col(100) - start_points().col(0) - Vector3d(2, 0, 0)).norm() <
          float_gap);
    const CsrbfField& last = deformer.fields().fields().back();
    CHECK((last.centres.col(1) - start_points().col(1) - Vector3d(0, 0.2, 0)).norm() <
          float_gap); // a centre is where float holds it
    tips(0, 0) += 0.4;
    CHECK(deformer.stroke_to(tips).pieces == 0);
    tips(0, 0) += 0.2;
    CHECK(deformer.stroke_to(tips).pieces == 1);
    CHECK(deformer.end_at(tips).pieces == 1);
    CHECK((shape_of(deformer).col(100) - tips.col(0)).norm() < float_gap);
    CHECK(deformer.end_at(tips).pieces == 0);
  }

  TEST_CASE("finer pieces of a straight stroke converge, to something near Type-1 if it is short") {
    std::mt19937 random(32);
    const Points way = random_points(random, 10, 1.0);
    const Points ends = start_points() + way;
    double last = 1e9;
    Points coarse = stroked(ends, 4);
    for (const int pieces : {8, 16, 32, 64}) {
      const Points fine = stroked(ends, pieces);
      const double change = largest(fine - coarse);
      CHECK(change < 0.7 * last);
      last = change;
      coarse = fine;
    }
    // The two differ by what the step adds in second order: a tenth of the step, a hundredth of the
    // difference.
    const auto gap_to_type1 = [&](double scale) {
      Type1Deformer type1(clay, 10, {one_radius(6.0)});
      BlockShape shape;
      Points once;
      type1.grab(start_points());
      type1.apply(start_points() + scale * way, shape);
      type1.layout().unpack(shape, once);
      return largest(stroked(start_points() + scale * way, 16) - once);
    };
    CHECK(gap_to_type1(0.01) < 0.02 * gap_to_type1(0.1));
    CHECK(gap_to_type1(0.001) < 1e-5);
  }

  TEST_CASE("a jump is cut into a bounded number of pieces and arrives") {
    Type2Deformer deformer(clay, 10, 1e-6, {one_radius(6.0)});
    deformer.begin(start_points());
    CHECK(deformer.stroke_to(shifted({3, 0, 0})).pieces == FingertipCurve::max_pieces);
    CHECK((shape_of(deformer).col(100) - shifted({3, 0, 0}).col(0)).norm() < float_gap);
    CHECK(deformer.end_at(shifted({3, 0, 0})).pieces == 0);
    CHECK(is_solved(deformer.stroke_to(shifted({1e30, 0, 0})).status));
    CHECK(shape_of(deformer).allFinite());
  }

  TEST_CASE("fingertips that are not finite are refused, and the stroke continues after them") {
    Type2Deformer deformer(clay, 10, 0.1, {one_radius(6.0)});
    Points spoilt = start_points();
    spoilt(2, 2) = std::nan("");
    deformer.begin(spoilt);
    CHECK(deformer.stroke_to(start_points()).pieces == 0); // begins here
    for (const double bad : {std::nan(""), -1e300}) {
      spoilt(2, 2) = bad;
      const StrokeResult result = deformer.stroke_to(spoilt);
      CHECK(result.status == FieldStatus::not_finite);
      CHECK(result.pieces == 0);
    }
    CHECK(shape_of(deformer) == clay);
    CHECK(deformer.stroke_to(shifted({0.5, 0, 0})).status == FieldStatus::ok);
    deformer.end_at(shifted({0.5, 0, 0}));
    CHECK((shape_of(deformer).col(100) - shifted({0.5, 0, 0}).col(0)).norm() < float_gap);
  }

  TEST_CASE("two fingertips may cross on their way") {
    Type2Deformer deformer(clay, 2, 0.01, {one_radius(4.0), {.merge_fraction = 0.05}});
    Points tips(3, 2);
    tips << -1, 1, 0, 0, 5, 5;
    deformer.begin(tips);
    bool shared = false;
    for (int sample = -20; sample < 20; ++sample) {
      const double x = 0.05 * sample;
      tips(0, 0) = x;
      tips(0, 1) = -x;
      const StrokeResult result = deformer.stroke_to(tips);
      CHECK(is_solved(result.status));
      shared = shared || result.status == FieldStatus::merged;
    }
    CHECK(shared);
    CHECK(largest(shape_of(deformer) - clay) < 10.0);
  }

  TEST_CASE("coarse samples of a circle shape the model like fine ones, better than chords do") {
    const auto shaped = [](int samples, bool chords) {
      Type2Deformer deformer(clay, 10, 0.05, {one_radius(6.0)});
      const auto at = [](double turn) {
        return shifted({1.5 * std::sin(turn), 1.5 - 1.5 * std::cos(turn), 0.0});
      };
      deformer.begin(start_points());
      for (int sample = 1; sample <= samples; ++sample) {
        const Points tips = at(4.0 * sample / samples);
        chords ? deformer.end_at(tips) : deformer.stroke_to(tips);
        if (chords) deformer.begin(tips); // forgets where it came from
      }
      deformer.end_at(at(4.0));
      return shape_of(deformer);
    };
    const Points fine = shaped(400, false);
    CHECK(largest(shaped(10, false) - fine) < 0.25 * largest(shaped(10, true) - fine));
  }

  TEST_CASE("where one hand rests, out of the other's reach, nothing is touched") {
    Type2Deformer deformer(clay, 4, 0.05, {one_radius(1.5)});
    Points tips(3, 4);
    tips << 5, 4.9, -5, -4.9, 0, 1, 0, 1, 0, 0, 0, 0;
    deformer.begin(tips);
    const BlockShape before = deformer.shape();
    for (int sample = 1; sample <= 20; ++sample) {
      tips.leftCols<2>().row(2).array() += 0.04;
      tips(1, 2) = sample % 2 == 0 ? 0.01 : 0.0; // trembles
      deformer.stroke_to(tips);
    }
    int touched = 0;
    for (std::size_t block = 0; block < before.block_count(); ++block) {
      if (deformer.shape().stamp(block) == before.stamp(block)) continue;
      ++touched;
      CHECK(*std::max_element(before[block].x.begin(), before[block].x.end()) > 0.0F);
    }
    CHECK(touched > 0);
  }

  TEST_CASE("undo gives a stroke's beginning back, bit for bit, and again, and then no more") {
    DeformerOptions options;
    options.supports = one_radius(6.0);
    options.undo_bytes = std::size_t{1} << 20;
    Type2Deformer deformer(clay, 10, 0.1, options);
    std::vector<Points> shapes;
    const auto stroke = [&](double to) {
      deformer.begin(start_points());
      shapes.push_back(shape_of(deformer));
      deformer.end_at(shifted({0, to, 0.5}));
    };
    stroke(1.0);
    stroke(-0.5);
    stroke(0.25);
    CHECK(deformer.sculpted().undo_steps() == 2);
    Points nowhere = start_points();
    nowhere(0, 0) = std::nan("");
    const Points last = shape_of(deformer);
    CHECK(deformer.go(HistoryMove::undo, nowhere) ==
          FieldStatus::not_finite); // and nothing has changed
    CHECK(deformer.sculpted().undo_steps() == 2);
    CHECK(shape_of(deformer) == last);
    for (; !shapes.empty(); shapes.pop_back()) {
      CHECK(shape_of(deformer) != shapes.back());
      CHECK(deformer.go(HistoryMove::undo, start_points()) == FieldStatus::ok);
      CHECK(shape_of(deformer) == shapes.back());
    }
    CHECK(deformer.sculpted().undo_steps() == 0);
    CHECK(deformer.go(HistoryMove::undo, start_points()) == FieldStatus::ok);
    CHECK(shape_of(deformer) == clay);
    CHECK(deformer.go(HistoryMove::redo, nowhere) == FieldStatus::not_finite);
    CHECK(deformer.sculpted().redo_steps() == 3);
    CHECK(shape_of(deformer) == clay);
    CHECK(deformer.go(HistoryMove::undo, start_points()) == FieldStatus::ok);
    CHECK(deformer.end_at(shifted({0, 0.5, 0})).pieces > 0); // it holds the model
  }

  TEST_CASE("a stroke does not allocate") {
    Type2Deformer deformer(clay, 10, 0.1, {one_radius(6.0), {.polynomial = Polynomial::linear}});
    const Points starts = start_points();
    const Points ends = shifted({0.35, 0, 0});
    StrokeResult result;
    nendo::test::RestraintCounts counts;
    {
      const nendo::test::Restraint restraint;
      deformer.begin(starts);
      result = deformer.stroke_to(ends);
      deformer.end_at(ends);
      counts = restraint.counts();
    }
    CHECK(result.pieces == 3);
    CHECK(counts.allocations == 0);
  }
}

} // namespace type2_test
