#include <nendo/flow/sculptor.hpp>

#include <doctest/doctest.h>

#include "support/flow_fixtures.hpp"

namespace sculptor_test {

using namespace nendo;
using namespace nendo::flow;
using deform::FieldStatus;
using deform::Points;

namespace {

const Points rest = test::ball(11).vertices; // with an equator
const Points tips = (Points(3, 2) << 1.0, -1.0, 0.0, 0.0, 0.0, 0.0).finished();

SculptorOptions options_for(Mode mode) {
  SculptorOptions options;
  options.mode = mode;
  options.deformer.supports = deform::one_radius(0.6);
  options.piece_length = 0.03;
  return options;
}

/// A sculptor of two points, with its shape.
struct Sculpted {
  deform::SculptedShape shape;
  Sculptor sculptor;

  Sculpted(const Points& points, const SculptorOptions& options)
      : shape(points, options.deformer), sculptor(shape, 2, options) {}

  Points unpacked(const deform::BlockShape& of) const {
    Points points;
    shape.layout().unpack(of, points);
    return points;
  }
};

} // namespace

TEST_SUITE("sculptor") {
  TEST_CASE("modes have names") {
    for (const Mode mode : {Mode::type1, Mode::type2, Mode::clay})
      CHECK(mode_named(name_of(mode)) == mode);
    CHECK_FALSE(mode_named("type3").has_value());
  }

  TEST_CASE("in either mode unmoved fingertips leave the model as it is") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Sculpted ball(rest, options_for(mode));
      Sculptor& sculptor = ball.sculptor;
      REQUIRE(sculptor.grab(tips) == FieldStatus::ok);
      deform::BlockShape out;
      for (int turn = 0; turn < 3; ++turn)
        CHECK(sculptor.update(tips, out) == FieldStatus::ok);
      CHECK(ball.unpacked(out) == rest);
    }
  }

  TEST_CASE("in either mode a short stroke carries the touched vertex along, and finish leaves "
            "nothing out") {
    // Vertices of the ball's equator lie exactly at (1, 0, 0) and (-1, 0, 0).
    Points ends = tips;
    ends.col(0) += Eigen::Vector3d(0.0, 0.1, 0.0);
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Sculpted ball(rest, options_for(mode));
      Sculptor& sculptor = ball.sculptor;
      REQUIRE(sculptor.grab(tips) == FieldStatus::ok);
      deform::BlockShape shape;
      REQUIRE(sculptor.finish(ends, shape) == FieldStatus::ok);
      const Points out = ball.unpacked(shape);
      Eigen::Index touched = 0;
      (rest.colwise() - Eigen::Vector3d(tips.col(0))).colwise().squaredNorm().minCoeff(&touched);
      CHECK((out.col(touched) - ends.col(0)).norm() < test::float_gap);
      Eigen::Index far = 0;
      (rest.colwise() - Eigen::Vector3d(0.0, 0.0, 1.0)).colwise().squaredNorm().minCoeff(&far);
      CHECK(out.col(far) == rest.col(far));
    }
  }

  TEST_CASE("in either mode a second thread makes the same bits") {
    const Points ball = test::ball(90).vertices;
    Points ends = tips;
    ends.col(0) += Eigen::Vector3d(0.0, 0.1, 0.0);
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      SculptorOptions options = options_for(mode);
      Sculpted one(ball, options);
      options.deformer.evaluation.threads = 2;
      Sculpted two(ball, options);
      deform::BlockShape by_one;
      deform::BlockShape by_two;
      for (Sculpted* sculpted : {&one, &two})
        REQUIRE(sculpted->sculptor.grab(tips) == FieldStatus::ok);
      for (int turn = 0; turn < 20; ++turn) {
        ends(2, 0) += 0.01;
        one.sculptor.update(ends, by_one);
        two.sculptor.update(ends, by_two);
        REQUIRE(one.unpacked(by_one) == two.unpacked(by_two));
      }
      CHECK(one.unpacked(by_one) != ball);
    }
  }
}

} // namespace sculptor_test
