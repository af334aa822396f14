#include "motions/kneading_hand.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/cut.hpp>
#include <nendo/deform/edit_part.hpp>
#include <nendo/hand/hand_body.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "support/test_meshes.hpp"

namespace kneading_hand_test {

using namespace nendo;
using namespace nendo::motions;

namespace {

constexpr double size_m = 0.09;

KneadingHand hand_on(const deform::Mesh& model, Side side, KneadTask task) {
  auto made = KneadingHand::make(model, hand::HandSkeleton(side), task, size_m);
  REQUIRE(made);
  return *std::move(made);
}

/// How far the hand's body is from the model's vertices, which are not moved.
double clearance_m(const KneadingHand& hand, Side side, const deform::Mesh& model, double time_s) {
  const hand::HandSkeleton skeleton(side);
  hand::HandBody body(skeleton);
  body.follow(skeleton.pose(hand.angles(time_s), hand.wrist()->at(time_s)));
  double min_m = std::numeric_limits<double>::max();
  for (const auto vertex : model.vertices.colwise())
    min_m = std::min(min_m, body.nearest(0.5 * size_m * vertex).distance_m);
  return min_m;
}

} // namespace

TEST_SUITE("kneading_hand") {
  TEST_CASE("each hand begins and ends beside the model, and goes into it between") {
    const deform::Mesh ball = test::sphere(24, 36, 1.0);
    for (const KneadTask task : knead_tasks) {
      for (const Side side : {Side::left, Side::right}) {
        CAPTURE(name_of(task));
        CAPTURE(name_of(side));
        const KneadingHand hand = hand_on(ball, side, task);
        CHECK(clearance_m(hand, side, ball, 0.0) > 0.005);
        CHECK(clearance_m(hand, side, ball, hand.length_s() + 1.0) > 0.005);
        double min_m = 0.0;
        for (double time_s = 0.0; time_s < hand.length_s(); time_s += 0.05)
          min_m = std::min(min_m, clearance_m(hand, side, ball, time_s));
        CHECK((min_m < -0.005 || (task == KneadTask::knead && side == Side::left)));
      }
    }
  }

  TEST_CASE("motions are continuous, no faster than a hand, and within the joints' ranges") {
    constexpr double step_s = 0.002;
    constexpr double max_speed_m_s = 1.5;
    const deform::Mesh ball = test::sphere(8, 12, 1.0);
    for (const KneadTask task : knead_tasks) {
      for (const Side side : {Side::left, Side::right}) {
        CAPTURE(name_of(task));
        CAPTURE(name_of(side));
        const KneadingHand hand = hand_on(ball, side, task);
        double fastest_m_s = 0.0;
        double fastest_rad_s = 0.0;
        for (double time_s = 0.0; time_s < hand.length_s() + 0.5; time_s += step_s) {
          const Eigen::Vector3d way = hand.wrist()->at(time_s + step_s).translation() -
                                      hand.wrist()->at(time_s).translation();
          fastest_m_s = std::max(fastest_m_s, way.norm() / step_s);
          const hand::JointAngles now = hand.angles(time_s);
          const hand::JointAngles next = hand.angles(time_s + step_s);
          for (std::size_t k = 0; k < hand::angle_count; ++k) {
            const hand::Angle angle = hand::angle_at(k);
            fastest_rad_s = std::max(fastest_rad_s, std::abs(next[angle] - now[angle]) / step_s);
            CHECK(now[angle] >= hand::limit_of(angle).min_rad - 1e-9);
            CHECK(now[angle] <= hand::limit_of(angle).max_rad + 1e-9);
          }
        }
        CHECK(fastest_m_s < max_speed_m_s);
        CHECK(fastest_m_s > 0.02);
        CHECK(fastest_rad_s < 8.0);
      }
    }
  }

  TEST_CASE("of models side by side each hand takes the one on its side, and puts it down beside") {
    const std::array models{test::sphere(24, 36, 1.0), test::sphere(24, 36, 0.5)};
    const auto pair = deform::side_by_side(models);
    REQUIRE(pair);
    const auto extent = [](const deform::Mesh& mesh) -> Eigen::Vector3d {
      return mesh.vertices.rowwise().maxCoeff() - mesh.vertices.rowwise().minCoeff();
    };
    const double scale = size_m / extent(*pair).maxCoeff();
    const std::vector<deform::Mesh> balls = deform::separate(*pair);
    REQUIRE(balls.size() == 2);
    for (const deform::Mesh& ball : balls) {
      const Eigen::Vector3d middle_m =
          scale * 0.5 * (ball.vertices.rowwise().maxCoeff() + ball.vertices.rowwise().minCoeff());
      const double radius_m = 0.5 * scale * extent(ball).x();
      const bool is_first = &ball == &balls.front();
      const bool is_left =
          (balls[0].vertices.row(0).mean() < balls[1].vertices.row(0).mean()) == is_first;
      const Side side = is_left ? Side::left : Side::right;
      const double sign = is_left ? -1.0 : 1.0;
      CAPTURE(name_of(side));
      const KneadingHand hand = hand_on(*pair, side, KneadTask::carry);
      const auto pinched = [&](double time_s) -> Eigen::Vector3d {
        const auto pose =
            hand::HandSkeleton(side).pose(hand.angles(time_s), hand.wrist()->at(time_s));
        return 0.5 * (pose[hand::Joint::thumb_tip].translation() +
                      pose[hand::Joint::index_tip].translation());
      };
      const Eigen::Vector3d taken = pinched(1.75) - middle_m;
      CHECK(taken.norm() < radius_m + 0.01);
      CHECK(sign * taken.x() > 0.0);
      CHECK(taken.y() > 0.3 * radius_m);
      const Eigen::Vector3d way = pinched(6.9) - pinched(1.75);
      CHECK(sign * way.x() == doctest::Approx(0.7 * 2.0 * radius_m).epsilon(0.1));
      CHECK(std::abs(way.y()) < 0.003);
      CHECK(pinched(4.0).y() > pinched(1.75).y() + 0.4 * 2.0 * radius_m);
    }
  }

  TEST_CASE("the same arguments give the same motion, and odd times are the beginning or the end") {
    const deform::Mesh ball = test::sphere(8, 12, 1.0);
    const KneadingHand one = hand_on(ball, Side::right, KneadTask::grip);
    const KneadingHand same = hand_on(ball, Side::right, KneadTask::grip);
    for (double time_s = 0.0; time_s < one.length_s(); time_s += 0.37) {
      CHECK(one.wrist()->at(time_s).matrix() == same.wrist()->at(time_s).matrix());
      CHECK(one.angles(time_s).thumb_roll_rad == same.angles(time_s).thumb_roll_rad);
    }
    const auto first = one.wrist()->at(0.0).matrix();
    for (const double time_s : {-1.0, std::nan(""), -std::numeric_limits<double>::infinity()})
      CHECK(one.wrist()->at(time_s).matrix() == first);
    CHECK(one.wrist()->at(1e300).matrix() == one.wrist()->at(one.length_s()).matrix());
  }

  TEST_CASE("a model without vertices or size is an error") {
    deform::Mesh nothing;
    CHECK_FALSE(
        KneadingHand::make(nothing, hand::HandSkeleton(Side::right), KneadTask::press, size_m));
    deform::Mesh point;
    point.vertices = deform::Points::Zero(3, 1);
    CHECK_FALSE(
        KneadingHand::make(point, hand::HandSkeleton(Side::right), KneadTask::press, size_m));
  }
}

} // namespace kneading_hand_test
