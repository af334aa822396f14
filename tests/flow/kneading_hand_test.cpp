#include <nendo/flow/kneading_hand.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include <doctest/doctest.h>

#include <nendo/hand/hand_body.hpp>
#include <nendo/hand/joint_limits.hpp>

#include "support/test_meshes.hpp"

namespace kneading_hand_test {

using namespace nendo;
using namespace nendo::flow;

namespace {

constexpr double size_m = 0.09;
constexpr std::array tasks{KneadTask::press, KneadTask::knead, KneadTask::grip, KneadTask::carry,
                           KneadTask::bore,  KneadTask::cut,   KneadTask::slice};

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
  double least_m = std::numeric_limits<double>::max();
  for (const auto vertex : model.vertices.colwise())
    least_m = std::min(least_m, body.nearest(0.5 * size_m * vertex).distance_m);
  return least_m;
}

} // namespace

TEST_SUITE("kneading_hand") {
  TEST_CASE("tasks have names") {
    for (const KneadTask task : tasks)
      CHECK(knead_task_named(name_of(task)) == task);
    CHECK_FALSE(knead_task_named("touch").has_value());
    CHECK_FALSE(knead_task_named("").has_value());
  }

  TEST_CASE("each hand begins and ends beside the model, and goes into it between") {
    const deform::Mesh ball = test::sphere(24, 36, 1.0);
    for (const KneadTask task : tasks) {
      for (const Side side : {Side::left, Side::right}) {
        CAPTURE(name_of(task));
        CAPTURE(name_of(side));
        const KneadingHand hand = hand_on(ball, side, task);
        CHECK(clearance_m(hand, side, ball, 0.0) > 0.005);
        CHECK(clearance_m(hand, side, ball, hand.length_s() + 1.0) > 0.005);
        double least_m = 0.0;
        for (double time_s = 0.0; time_s < hand.length_s(); time_s += 0.05)
          least_m = std::min(least_m, clearance_m(hand, side, ball, time_s));
        CHECK((least_m < -0.005 || (task == KneadTask::knead && side == Side::left)));
      }
    }
  }

  TEST_CASE("motions are continuous, no faster than a hand, and within the joints' ranges") {
    constexpr double step_s = 0.002;
    constexpr double most_speed_m_s = 1.5;
    const deform::Mesh ball = test::sphere(8, 12, 1.0);
    for (const KneadTask task : tasks) {
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
            CHECK(now[angle] >= hand::limit_of(angle).least_rad - 1e-9);
            CHECK(now[angle] <= hand::limit_of(angle).most_rad + 1e-9);
          }
        }
        CHECK(fastest_m_s < most_speed_m_s);
        CHECK(fastest_m_s > 0.02);
        CHECK(fastest_rad_s < 8.0);
      }
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
