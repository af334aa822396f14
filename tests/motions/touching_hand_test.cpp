#include "motions/touching_hand.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <string>
#include <thread>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/deform/mesh_file.hpp>
#include <nendo/driver/simulated_glove.hpp>
#include <nendo/hand/joint_limits.hpp>
#include <nendo/hand/sensor_gate.hpp>

#include "support/required.hpp"
#include "support/surface_distance.hpp"
#include "support/test_meshes.hpp"

namespace touching_hand_test {

using namespace nendo;
using namespace nendo::motions;
using hand::Finger;

namespace {

constexpr std::array touch_fingers{Finger::thumb, Finger::index, Finger::middle, Finger::ring,
                                   Finger::little};

TouchingHand hand_on(const deform::Mesh& model, Side side, const TouchOptions& options = {}) {
  auto made = TouchingHand::make(model, hand::HandSkeleton(side), options);
  REQUIRE(made);
  return *std::move(made);
}

deform::Mesh shipped(const std::string& name) {
  auto model = deform::read_mesh(NENDO_MODELS + ("/" + name));
  REQUIRE(model);
  return *std::move(model);
}

/// As it is on the stage, whose models are 80 cm on their longest side.
deform::Mesh on_stage(deform::Mesh model) {
  const Eigen::Vector3d extent =
      model.vertices.rowwise().maxCoeff() - model.vertices.rowwise().minCoeff();
  model.vertices *= 0.8 / extent.maxCoeff();
  return model;
}

flow::Fingertips tips_at(const TouchingHand& hand, Side side, double time_s) {
  return hand::HandSkeleton(side)
      .pose(hand.angles(time_s), hand.wrist_pose())
      .fingertip_positions();
}

// flow::Fingertips on the surface wherever the depth is 0, and in or out of it by the depth
// elsewhere.
void check_touch(const TouchingHand& hand, Side side, const deform::Mesh& stage) {
  const deform::Points normals = deform::vertex_normals(stage);
  int on_it = 0;
  for (double t = 0.0; t < hand.period_s(); t += 0.613) {
    const flow::Fingertips tips = tips_at(hand, side, t);
    for (std::size_t k = 0; k < touch_fingers.size(); ++k) {
      const TouchTarget target = hand.target(touch_fingers[k], t);
      const Eigen::Vector3d tip = tips.col(static_cast<Eigen::Index>(k));
      CHECK((tip - (target.contact_m - target.depth_m * target.normal)).norm() < 1e-4);
      const auto contact = test::nearest_triangle(stage, target.contact_m);
      CHECK(contact.distance < 1e-4);
      CHECK(target.normal.norm() == doctest::Approx(1.0));
      CHECK(target.normal.dot(contact.normal) > 0.5); // vertices' normals, and this is one face's
      if (target.depth_m != 0.0) continue;
      CHECK(test::nearest_triangle(stage, tip).distance < 1e-4);
      ++on_it;
    }
  }
  CHECK(on_it > 30);
}

void check_reach(const TouchingHand& hand) {
  for (const Finger finger : touch_fingers) {
    CHECK(hand.touches(finger));
    const Eigen::Vector3d first = hand.target(finger, 0.0).contact_m;
    double in_m = 0.0;
    double out_m = 0.0;
    double glide_m = 0.0;
    for (double t = 0.0; t < hand.period_s(); t += 0.05) {
      const TouchTarget target = hand.target(finger, t);
      in_m = std::max(in_m, target.depth_m);
      out_m = std::max(out_m, -target.depth_m);
      glide_m = std::max(glide_m, (target.contact_m - first).norm());
    }
    CHECK(in_m > 0.007);
    CHECK(in_m <= TouchOptions{}.press_m);
    CHECK(out_m > 0.04); // by the wrist: what one sees
    CHECK(out_m <= TouchOptions{}.pull_m);
    CHECK(glide_m > 0.005);
  }
}

// At any time, not at the keys only: the steps fall on no key but the first.
void check_motion(const TouchingHand& hand, Side side) {
  constexpr double step_s = 0.00711;
  double fastest_rad_s = 0.0;
  double beyond_rad = 0.0;
  double off_m = 0.0;
  hand::JointAngles before = hand.angles(0.0);
  for (double t = 0.0; t < hand.period_s() + 2.0; t += step_s) {
    const hand::JointAngles now = hand.angles(t);
    for (std::size_t k = 0; k < hand::angle_count; ++k) {
      const hand::Angle angle = hand::angle_at(k);
      const auto& limit = hand::limit_of(angle);
      beyond_rad =
          std::max({beyond_rad, now[angle] - limit.soft_max_rad, limit.soft_min_rad - now[angle]});
      fastest_rad_s = std::max(fastest_rad_s, std::abs(now[angle] - before[angle]) / step_s);
    }
    const flow::Fingertips tips = tips_at(hand, side, t);
    for (std::size_t k = 0; k < touch_fingers.size(); ++k)
      off_m = std::max(off_m, (tips.col(static_cast<Eigen::Index>(k)) -
                               hand.target(touch_fingers[k], t).place_m())
                                  .norm());
    before = now;
  }
  CHECK(beyond_rad < from_degrees(0.1));
  CHECK(fastest_rad_s > 0.5);
  CHECK(fastest_rad_s < 6.0); // a quarter of the limit of hand::SensorGate
  CHECK(off_m < TouchingHand::tolerance_m);
}

/// What holds on any model; and `also`, of each hand.
template <class Check>
void check_hands_on(const deform::Mesh& model, Check also) {
  for (const Side side : {Side::left, Side::right}) {
    const TouchingHand hand = hand_on(model, side);
    check_touch(hand, side, on_stage(model));
    check_reach(hand);
    check_motion(hand, side);
    also(hand, side);
  }
}

constexpr auto nothing_else = [](const TouchingHand&, Side) {};

} // namespace

TEST_SUITE("touching_hand") {
  TEST_CASE("both hands touch the shipped Moai, within the joints' limits and speed") {
    check_hands_on(shipped("moai.obj"), nothing_else);
  }

  TEST_CASE("both hands touch the shipped head, within the joints' limits and speed") {
    check_hands_on(shipped("head.obj"), nothing_else);
  }

  TEST_CASE("both hands touch a ball, press inwards and pull outwards") {
    check_hands_on(test::sphere(32, 64, 5.0), [](const TouchingHand& hand, Side side) {
      for (double t = 0.0; t < hand.period_s(); t += 0.1) {
        const flow::Fingertips tips = tips_at(hand, side, t);
        for (std::size_t k = 0; k < touch_fingers.size(); ++k) {
          const double radius_m = tips.col(static_cast<Eigen::Index>(k)).norm();
          const double depth_m = hand.target(touch_fingers[k], t).depth_m;
          // Of 0.4 m; the faces' middles lie up to 1 mm under the ball.
          CHECK(std::abs(radius_m - (0.4 - depth_m)) < 0.0015);
        }
      }
    });
  }

  TEST_CASE("joint_angles() makes the same angles of the sensors' angles") {
    const TouchingHand hand = hand_on(test::sphere(16, 24, 1.0), Side::left);
    hand::Calibration fine;
    for (auto& sensor : fine.sensors)
      sensor = {1e-4, 32768.0};
    for (double t = 0.0; t < 2.0 * hand.period_s(); t += 0.37) {
      GloveSample sample;
      const hand::SensorAngles sensors = hand.sensor_angles(t);
      for (std::size_t k = 0; k < sensor_slots; ++k) {
        if (sensors_22.has(static_cast<Sensor>(k)))
          sample.set(static_cast<Sensor>(k),
                     {static_cast<std::uint16_t>(std::lround(32768.0 + 1e4 * sensors[k]))});
        else
          CHECK(sensors[k] == 0.0);
      }
      const hand::JointAngles seen = hand::joint_angles(sample, fine);
      const hand::JointAngles meant = hand.angles(t);
      for (std::size_t k = 0; k < hand::angle_count; ++k)
        CHECK(std::abs(seen[hand::angle_at(k)] - meant[hand::angle_at(k)]) < 3e-4);
    }
  }

  TEST_CASE("the same seed gives the same motion, another one another, and it is repeated") {
    const deform::Mesh ball = test::sphere(16, 24, 1.0);
    const TouchingHand one = hand_on(ball, Side::right);
    const TouchingHand same = hand_on(ball, Side::right);
    const TouchingHand other = hand_on(ball, Side::right, {.seed = 2});
    const double later_s = one.period_s() + 3.7;
    CHECK(one.sensor_angles(3.7) == same.sensor_angles(3.7));
    CHECK(one.sensor_angles(3.7) != other.sensor_angles(3.7));
    for (std::size_t k = 0; k < sensor_slots; ++k)
      CHECK(std::abs(one.sensor_angles(later_s)[k] - one.sensor_angles(3.7)[k]) < 1e-9);
  }

  TEST_CASE(
      "through a glove's counts and the default calibration the touch is off by millimetres") {
    const TouchingHand hand = hand_on(test::sphere(16, 24, 1.0), Side::right);
    constexpr double speed = 20.0; // a cycle in a second, for the sake of the test
    driver::SimulatedGloveOptions options;
    options.rate_hz = 1000.0;
    const auto glove = driver::make_simulated_glove(
        options, [hand](double time_s) { return hand.sensor_angles(speed * time_s); });
    SampleRing ring(4096);
    test::require_ok(glove->start(ring));
    std::vector<double> off_mm;
    const auto deadline = HostClock::now() + std::chrono::seconds(60);
    while (off_mm.size() < 5 * 500 && HostClock::now() < deadline) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      ring.drain([&](const GloveSample& sample) {
        const auto angles = hand::joint_angles(sample, hand::default_calibration());
        const flow::Fingertips tips =
            hand::HandSkeleton(Side::right).pose(angles, hand.wrist_pose()).fingertip_positions();
        const double time_s = speed * to_seconds(sample.device_time);
        for (std::size_t k = 0; k < touch_fingers.size(); ++k)
          off_mm.push_back(1e3 * (tips.col(static_cast<Eigen::Index>(k)) -
                                  hand.target(touch_fingers[k], time_s).place_m())
                                     .norm());
      });
    }
    glove->stop();
    REQUIRE(off_mm.size() >= 5 * 500);
    std::sort(off_mm.begin(), off_mm.end());
    const double median = off_mm[off_mm.size() / 2];
    const double p95 = off_mm[off_mm.size() * 19 / 20];
    INFO("p50 " << median << " mm, p95 " << p95 << " mm");
    CHECK(median > 0.6); // 8 bits do not go unnoticed
    CHECK(median < 2.0);
    CHECK(p95 < 4.0);
  }

  TEST_CASE("no sensor is taken for a spike at 90 Hz") {
    const TouchingHand hand = hand_on(test::sphere(16, 24, 1.0), Side::left);
    hand::SensorGate gate;
    const hand::Calibration calibration = hand::default_calibration();
    const HostTime start = HostClock::now();
    for (int n = 0; n < 4000; ++n) {
      GloveSample sample;
      sample.side = Side::left;
      sample.arrival = sample.measured = start + n * std::chrono::microseconds(11'111);
      sample.has_device_time = true;
      const auto angles = hand.sensor_angles(n / 90.0);
      for (std::size_t k = 0; k < sensor_slots; ++k) {
        const auto& [gain, offset] = calibration.sensors[k];
        if (gain != 0.0)
          sample.set(static_cast<Sensor>(k),
                     {static_cast<std::uint16_t>(std::lround(offset + angles[k] / gain))});
      }
      CHECK(gate.pass(sample, calibration).raw == sample.raw);
    }
  }

  TEST_CASE("absurd times and models do no harm") {
    const deform::Mesh ball = test::sphere(8, 12, 1.0);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    const auto hand = hand_on(ball, Side::right);
    for (const double time_s : {nan, -1.0, 1e300, std::numeric_limits<double>::infinity()}) {
      CHECK(tips_at(hand, Side::right, time_s).allFinite());
      CHECK(hand.target(Finger::index, time_s).place_m().allFinite());
    }
    deform::Mesh points;
    points.vertices = ball.vertices;
    const auto none = TouchingHand::make(points, hand::HandSkeleton(Side::right));
    REQUIRE_FALSE(none);
    CHECK(none.error().code == Errc::bad_input);
    deform::Mesh triangle;
    triangle.vertices.resize(3, 3);
    triangle.vertices << 0, 1, 0, 0, 0, 1, 0, 0, 0;
    test::add_face(triangle, {0, 1, 2});
    const auto some = TouchingHand::make(triangle, hand::HandSkeleton(Side::right));
    if (some) {
      for (double t = 0.0; t < some->period_s(); t += 0.5)
        CHECK(tips_at(*some, Side::right, t).allFinite());
    }
  }
}

} // namespace touching_hand_test
