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

Points unpacked(const Sculptor& sculptor, const deform::BlockShape& shape) {
  Points points;
  sculptor.layout().unpack(shape, points);
  return points;
}

} // namespace

TEST_SUITE("sculptor") {
  TEST_CASE("modes have names") {
    for (const Mode mode : {Mode::type1, Mode::type2, Mode::clay})
      CHECK(mode_named(name_of(mode)) == mode);
    CHECK_FALSE(mode_named("type3").has_value());
  }

  TEST_CASE("in either mode unmoved fingertips leave the model as it is") {
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Sculptor sculptor(rest, 2, options_for(mode));
      REQUIRE(sculptor.grab(tips) == FieldStatus::ok);
      deform::BlockShape out;
      for (int turn = 0; turn < 3; ++turn)
        CHECK(sculptor.update(tips, out) == FieldStatus::ok);
      CHECK(unpacked(sculptor, out) == rest);
    }
  }

  TEST_CASE("in either mode a short stroke carries the touched vertex along, and finish leaves "
            "nothing out") {
    // Vertices of the ball's equator lie exactly at (1, 0, 0) and (-1, 0, 0).
    Points ends = tips;
    ends.col(0) += Eigen::Vector3d(0.0, 0.1, 0.0);
    for (const Mode mode : {Mode::type1, Mode::type2}) {
      Sculptor sculptor(rest, 2, options_for(mode));
      REQUIRE(sculptor.grab(tips) == FieldStatus::ok);
      deform::BlockShape shape;
      REQUIRE(sculptor.finish(ends, shape) == FieldStatus::ok);
      const Points out = unpacked(sculptor, shape);
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
      Sculptor one(ball, 2, options);
      options.deformer.evaluation.threads = 2;
      Sculptor two(ball, 2, options);
      deform::BlockShape by_one;
      deform::BlockShape by_two;
      for (Sculptor* sculptor : {&one, &two})
        REQUIRE(sculptor->grab(tips) == FieldStatus::ok);
      for (int turn = 0; turn < 20; ++turn) {
        ends(2, 0) += 0.01;
        one.update(ends, by_one);
        two.update(ends, by_two);
        REQUIRE(unpacked(one, by_one) == unpacked(two, by_two));
      }
      CHECK(unpacked(one, by_one) != ball);
    }
  }
}

} // namespace sculptor_test
