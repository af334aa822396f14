// Several deformers on one shape, one after another: its history reaches across all of them.

#include <nendo/deform/sculpted_shape.hpp>

#include <random>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/type1.hpp>
#include <nendo/deform/type2.hpp>

#include "support/fields.hpp"
#include "support/test_meshes.hpp"

namespace sculpted_shape_test {

using namespace nendo::deform;

namespace {

constexpr double gap = 5e-6; // of float, in a model of this size

/// A ball that is held at ten points.
struct Sculpted {
  Points rest = nendo::test::sphere(20, 30, 5.0).vertices;
  DeformerOptions options = [] {
    DeformerOptions of_history;
    of_history.supports = one_radius(3.0);
    of_history.undo_bytes = std::size_t{1} << 20;
    return of_history;
  }();
  SculptedShape shape{rest, options};
  std::mt19937 random{5};
  Points starts = nendo::test::random_points(random, 10, 5.0);
  Points ends = starts + nendo::test::random_points(random, 10, 0.5);

  Points now() const {
    Points points;
    shape.layout().unpack(shape.shape(), points);
    return points;
  }
  Type1Deformer type1(double radius) {
    DeformerOptions other = options;
    other.supports = one_radius(radius);
    return {shape, starts.cols(), other};
  }
  Type2Deformer type2(double radius) {
    DeformerOptions other = options;
    other.supports = one_radius(radius);
    return {shape, starts.cols(), 0.1, other};
  }
  void pull(double radius, bool is_step) {
    Type1Deformer deformer = type1(radius);
    REQUIRE(is_solved(deformer.grab(starts)));
    BlockShape out;
    REQUIRE(is_solved(deformer.apply(ends, out)));
    deformer.release(is_step);
    Points applied;
    shape.layout().unpack(out, applied);
    CHECK((applied - now()).cwiseAbs().maxCoeff() < gap); // what was shown is what stays
  }
  void stroke(double radius, bool is_step) {
    Type2Deformer deformer = type2(radius);
    REQUIRE(is_solved(deformer.grab(starts)));
    REQUIRE(is_solved(deformer.end_at(ends).status));
    deformer.release(is_step);
  }
};

double distance(const Points& a, const Points& b) {
  return (a - b).cwiseAbs().maxCoeff();
}

} // namespace

TEST_SUITE("sculpted_shape") {
  TEST_CASE("undo leads back over the work of deformers that are gone, and redo forth") {
    Sculpted sculpted;
    std::vector<Points> shapes{sculpted.now()};
    CHECK(distance(shapes[0], sculpted.rest) == 0.0);
    for (const double radius : {3.0, 1.5, 2.0}) {
      sculpted.pull(radius, true);
      shapes.push_back(sculpted.now());
      sculpted.stroke(radius, true);
      shapes.push_back(sculpted.now());
    }
    for (std::size_t at = 1; at < shapes.size(); ++at)
      CHECK(distance(shapes[at], shapes[at - 1]) > 1e-2);
    CHECK(sculpted.shape.undo_steps() == 6);
    Type1Deformer last = sculpted.type1(1.0);
    Type2Deformer other = sculpted.type2(1.0);
    for (std::size_t at = 6; at > 0; --at) {
      CHECK(is_solved(at % 2 == 0 ? last.go(HistoryMove::undo, sculpted.starts)
                                  : other.go(HistoryMove::undo, sculpted.starts)));
      CHECK(distance(sculpted.now(), shapes[at - 1]) == 0.0);
    }
    CHECK(sculpted.shape.undo_steps() == 0);
    CHECK(sculpted.shape.redo_steps() == 6);
    for (std::size_t at = 1; at <= 6; ++at) {
      CHECK(is_solved(at % 2 == 0 ? last.go(HistoryMove::redo, sculpted.starts)
                                  : other.go(HistoryMove::redo, sculpted.starts)));
      CHECK(distance(sculpted.now(), shapes[at]) == 0.0);
    }
  }

  TEST_CASE("what is released without a step is a step together with the next one") {
    Sculpted sculpted;
    sculpted.pull(3.0, false);
    sculpted.stroke(2.0, false);
    CHECK(sculpted.shape.undo_steps() == 0);
    sculpted.pull(1.5, true);
    CHECK(sculpted.shape.undo_steps() == 1);
    Type2Deformer last = sculpted.type2(1.0);
    REQUIRE(is_solved(last.go(HistoryMove::undo, sculpted.starts)));
    CHECK(distance(sculpted.now(), sculpted.rest) == 0.0);
    REQUIRE(is_solved(last.go(HistoryMove::redo, sculpted.starts)));
    // One that is not yet a step becomes one when it is undone.
    const Points before = sculpted.now();
    sculpted.pull(3.0, false);
    const Points pulled = sculpted.now();
    Type1Deformer undoing = sculpted.type1(1.0);
    REQUIRE(is_solved(undoing.go(HistoryMove::undo, sculpted.starts)));
    CHECK(distance(sculpted.now(), before) == 0.0);
    REQUIRE(is_solved(undoing.go(HistoryMove::redo, sculpted.starts)));
    CHECK(distance(sculpted.now(), pulled) == 0.0);
  }

  TEST_CASE("hands that have not moved leave no step, and the shape to the last bit") {
    Sculpted sculpted;
    Type1Deformer deformer = sculpted.type1(3.0);
    REQUIRE(is_solved(deformer.grab(sculpted.starts)));
    BlockShape out;
    REQUIRE(is_solved(deformer.apply(sculpted.starts, out)));
    deformer.release(true);
    CHECK(distance(sculpted.now(), sculpted.rest) == 0.0);
    CHECK(sculpted.shape.undo_steps() == 0);
  }

  TEST_CASE("a reset is a step, from whatever shape to the original") {
    for (const bool type1 : {true, false}) {
      Sculpted sculpted;
      sculpted.pull(3.0, true);
      const Points pulled = sculpted.now();
      Type1Deformer first = sculpted.type1(2.0);
      Type2Deformer second = sculpted.type2(2.0);
      REQUIRE(is_solved(type1 ? first.go(HistoryMove::reset, sculpted.ends)
                              : second.go(HistoryMove::reset, sculpted.ends)));
      CHECK(distance(sculpted.now(), sculpted.rest) == 0.0);
      CHECK(sculpted.shape.undo_steps() == 2);
      REQUIRE(is_solved(type1 ? first.go(HistoryMove::undo, sculpted.ends)
                              : second.go(HistoryMove::undo, sculpted.ends)));
      CHECK(distance(sculpted.now(), pulled) == 0.0);
      const Points nowhere = Points::Constant(3, 10, std::numeric_limits<double>::quiet_NaN());
      CHECK_FALSE(is_solved(type1 ? first.go(HistoryMove::reset, nowhere)
                                  : second.go(HistoryMove::reset, nowhere)));
      CHECK(distance(sculpted.now(), pulled) == 0.0);
    }
  }

  TEST_CASE("nothing is undone behind a fence, and all of it when the fence has gone") {
    Sculpted sculpted;
    sculpted.pull(3.0, true);
    sculpted.pull(2.0, true);
    Type1Deformer deformer = sculpted.type1(1.0);
    REQUIRE(is_solved(deformer.go(HistoryMove::undo, sculpted.starts)));
    sculpted.shape.fence(); // and what could be redone is forgotten
    const Points fenced = sculpted.now();
    CHECK(sculpted.shape.undo_steps() == 0);
    CHECK(sculpted.shape.redo_steps() == 0);
    REQUIRE(is_solved(deformer.go(HistoryMove::undo, sculpted.starts)));
    CHECK(distance(sculpted.now(), fenced) == 0.0);
    sculpted.stroke(2.0, true);
    CHECK(sculpted.shape.undo_steps() == 1);
    REQUIRE(is_solved(deformer.go(HistoryMove::undo, sculpted.starts)));
    REQUIRE(is_solved(deformer.go(HistoryMove::undo, sculpted.starts)));
    CHECK(distance(sculpted.now(), fenced) == 0.0);
    sculpted.shape.unfence();
    CHECK(sculpted.shape.undo_steps() == 1);
    REQUIRE(is_solved(deformer.go(HistoryMove::undo, sculpted.starts)));
    CHECK(distance(sculpted.now(), sculpted.rest) == 0.0);
  }

  TEST_CASE("where memory ends the steps behind the fence go first, and the count stays right") {
    Sculpted sculpted;
    DeformerOptions little = sculpted.options;
    little.undo_bytes = std::size_t{832} * 40; // some four of these steps
    SculptedShape shape(sculpted.rest, little);
    DeformerOptions other = little;
    Type1Deformer deformer(shape, 10, other);
    const auto pull = [&] {
      BlockShape out;
      REQUIRE(is_solved(deformer.grab(sculpted.starts)));
      REQUIRE(is_solved(deformer.apply(sculpted.ends, out)));
      deformer.release(true);
    };
    for (int at = 0; at < 3; ++at)
      pull();
    shape.fence();
    for (int at = 0; at < 30; ++at) {
      pull();
      CHECK(shape.undo_steps() <= static_cast<std::size_t>(at) + 1);
      CHECK(shape.undo_steps() > 0);
    }
    CHECK(shape.forgotten_steps() > 20);
    shape.unfence();
    while (shape.undo_steps() > 0)
      REQUIRE(is_solved(deformer.go(HistoryMove::undo, sculpted.starts)));
  }

  TEST_CASE("a shape that begins as another one is that, and resets to its own") {
    Sculpted sculpted;
    sculpted.pull(3.0, true);
    SculptedShape shape(sculpted.rest, sculpted.options, &sculpted.shape.shape());
    Points points;
    shape.layout().unpack(shape.shape(), points);
    CHECK(distance(points, sculpted.now()) == 0.0);
    Type2Deformer deformer(shape, 10, 0.1, sculpted.options);
    REQUIRE(is_solved(deformer.go(HistoryMove::undo, sculpted.starts))); // there is nothing to undo
    shape.layout().unpack(shape.shape(), points);
    CHECK(distance(points, sculpted.now()) == 0.0);
    REQUIRE(is_solved(deformer.go(HistoryMove::reset, sculpted.starts)));
    shape.layout().unpack(shape.shape(), points);
    CHECK(distance(points, sculpted.rest) == 0.0);
  }
}

} // namespace sculpted_shape_test
