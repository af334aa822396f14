#include "evdev/evdev_motion.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <doctest/doctest.h>

namespace evdev_motion_test {

using namespace nendo;
using namespace nendo::driver::evdev;
using namespace std::chrono_literals;

namespace {

/// A device whose time the test advances in steps of 5 ms.
struct Device {
  explicit Device(InputKind kind, std::uint16_t first_button = BTN_0) {
    motion.set_device(kind, first_button);
    if (kind == InputKind::gamepad) {
      for (const unsigned stick : {0U, 1U, 3U, 4U}) // ABS_X, ABS_Y, ABS_RX, ABS_RY
        motion.set_range(stick, {-32768, 32767, 128});
      for (const unsigned trigger : {2U, 5U}) // ABS_Z, ABS_RZ
        motion.set_range(trigger, {0, 255, 0});
    }
    motion.advance(now);
  }
  void send(int type, int code, int value) {
    motion.take({static_cast<std::uint16_t>(type), static_cast<std::uint16_t>(code), value}, now);
  }
  void wait(std::chrono::milliseconds time) {
    for (const HostTime until = now + time; now < until;) {
      now += 5ms;
      motion.advance(now);
      path.push_back(motion.pose().position_m);
    }
  }
  double place(std::size_t k) const { return motion.pose().position_m[k]; }
  /// The rotation vector, of small turns.
  double turn(std::size_t k) const { return 2.0 * motion.pose().turn_xyzw[k]; }

  HostTime now{1s};
  EvdevMotion motion{MotionScale{0.2, 0.5}};
  std::vector<std::array<double, 3>> path; ///< a place each 5 ms
};

void check_pose(const InputPose& pose) {
  double norm = 0.0;
  for (const double part : pose.turn_xyzw)
    norm += part * part;
  CHECK(norm == doctest::Approx(1.0).epsilon(1e-9));
  for (const double place_m : pose.position_m)
    CHECK(std::abs(place_m) <= 0.5);
}

} // namespace

TEST_SUITE("evdev_motion") {
  TEST_CASE("each axis of a SpaceMouse moves or turns the pose about its own") {
    struct Case {
      int axis;
      std::size_t k; ///< axis of the stage: x right, y up, z towards the operator
      double sign;
    };
    // The cap's axes are x right, y towards the operator, z down.
    for (const InputKind kind : {InputKind::six_absolute, InputKind::six_relative}) {
      const int type = kind == InputKind::six_absolute ? EV_ABS : EV_REL;
      for (const Case& c : {Case{0, 0, 1}, Case{1, 2, 1}, Case{2, 1, -1}}) {
        CAPTURE(c.axis);
        Device device(kind);
        Device turned(kind);
        for (int k = 0; k < 20; ++k) { // a cap that is held repeats its deflection
          device.send(type, c.axis, 350);
          turned.send(type, 3 + c.axis, 350);
          device.wait(10ms);
          turned.wait(10ms);
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const double sign = k == c.k ? c.sign : 0.0;
          CHECK(device.place(k) == doctest::Approx(sign * 0.2 * 0.2));
          CHECK(device.turn(k) == doctest::Approx(0.0));
          CHECK(turned.place(k) == doctest::Approx(0.0));
          CHECK(turned.turn(k) == doctest::Approx(sign * 0.5 * 0.2).epsilon(0.01));
        }
      }
    }
  }

  TEST_CASE("half a deflection is nearly half the speed, and the dead zone is rest") {
    Device device(InputKind::six_absolute);
    device.send(EV_ABS, ABS_X, -175);
    device.wait(1s);
    CHECK(device.place(0) == doctest::Approx(-0.1).epsilon(0.05));
    device.send(EV_ABS, ABS_X, 9);
    CHECK_FALSE(device.motion.is_moving());
    device.motion.set_range(ABS_Y, {-350, 350, 100});
    device.send(EV_ABS, ABS_Y, 99);
    CHECK_FALSE(device.motion.is_moving());
    device.send(EV_ABS, ABS_Y, 120);
    CHECK(device.motion.is_moving());
  }

  TEST_CASE("a relative axis that is repeated no longer is at rest") {
    Device device(InputKind::six_relative);
    device.send(EV_REL, REL_X, 350);
    device.send(EV_SYN, SYN_REPORT, 0);
    device.wait(40ms);
    CHECK(device.motion.is_moving());
    device.wait(30ms);
    CHECK_FALSE(device.motion.is_moving());
    CHECK(device.place(0) < 0.2 * 0.08);
  }

  TEST_CASE("a gamepad's sticks move and turn, and its triggers move away and back") {
    struct Case {
      int axis;
      int value;
      bool turns;
      std::size_t k;
      double sign;
    };
    for (const Case& c : {Case{ABS_X, 32767, false, 0, 1}, Case{ABS_Y, 32767, false, 1, -1},
                          Case{ABS_RZ, 255, false, 2, -1}, Case{ABS_Z, 255, false, 2, 1},
                          Case{ABS_RX, 32767, true, 1, -1}, Case{ABS_RY, 32767, true, 0, 1}}) {
      CAPTURE(c.axis);
      Device device(InputKind::gamepad, BTN_SOUTH);
      device.send(EV_ABS, c.axis, c.value);
      device.wait(100ms);
      for (std::size_t k = 0; k < 3; ++k) {
        const double sign = k == c.k ? c.sign : 0.0;
        CHECK(device.place(k) == doctest::Approx(c.turns ? 0.0 : sign * 0.02));
        CHECK(device.turn(k) == doctest::Approx(c.turns ? sign * 0.05 : 0.0).epsilon(0.01));
      }
      device.send(EV_ABS, c.axis, 0); // a stick's middle, and a trigger's rest
      CHECK_FALSE(device.motion.is_moving());
    }
  }

  TEST_CASE("a mouse moves the pose by its counts, in small steps") {
    Device device(InputKind::mouse, BTN_LEFT);
    device.send(EV_REL, REL_X, 100);
    device.send(EV_REL, REL_Y, 50);
    device.send(EV_REL, REL_WHEEL, 2);
    CHECK(device.motion.is_moving());
    device.wait(600ms);
    CHECK_FALSE(device.motion.is_moving());
    CHECK(device.place(0) == doctest::Approx(100 * 0.0004 * 0.2));
    CHECK(device.place(1) == doctest::Approx(-50 * 0.0004 * 0.2));
    CHECK(device.place(2) == doctest::Approx(-2 * 0.02 * 0.2));
    for (std::size_t k = 1; k < device.path.size(); ++k)
      CHECK(std::abs(device.path[k][0] - device.path[k - 1][0]) < 0.002);
  }

  TEST_CASE("the first button moves the pose back to the start, as an arm moves") {
    Device device(InputKind::six_absolute, BTN_0);
    device.send(EV_ABS, ABS_X, 350);
    device.send(EV_ABS, ABS_RZ, 350);
    device.wait(3s);
    CHECK(device.place(0) == doctest::Approx(0.5)); // the box's side
    device.send(EV_ABS, ABS_X, 0);
    device.send(EV_ABS, ABS_RZ, 0);
    device.send(EV_KEY, BTN_1, 1); // another one
    CHECK_FALSE(device.motion.is_moving());
    device.path.clear();
    device.send(EV_KEY, BTN_0, 1);
    device.send(EV_KEY, BTN_0, 0);
    device.wait(600ms);
    CHECK_FALSE(device.motion.is_moving());
    CHECK(device.place(0) == doctest::Approx(0.0));
    CHECK(device.motion.pose().turn_xyzw[3] == doctest::Approx(1.0));
    // The gate of a wrist takes accelerations of 30 m/s^2.
    for (std::size_t k = 2; k < device.path.size(); ++k) {
      const double change = device.path[k][0] - 2.0 * device.path[k - 1][0] + device.path[k - 2][0];
      CHECK(std::abs(change) / (0.005 * 0.005) < 30.0);
    }
  }

  TEST_CASE("after dropped events the axes are at rest until their values are known") {
    Device device(InputKind::six_absolute);
    device.send(EV_ABS, ABS_X, 350);
    device.send(EV_SYN, SYN_DROPPED, 0);
    CHECK_FALSE(device.motion.is_moving());
    device.send(EV_ABS, ABS_Y, 350); // belongs to the dropped ones
    device.send(EV_KEY, BTN_0, 1);
    CHECK_FALSE(device.motion.is_moving());
    CHECK_FALSE(device.motion.needs_values());
    device.send(EV_SYN, SYN_REPORT, 0);
    CHECK(device.motion.needs_values());
    device.motion.set_value(ABS_X, 350);
    CHECK_FALSE(device.motion.needs_values());
    CHECK(device.motion.is_moving());
  }

  TEST_CASE("no event leaves the box, or makes a pose that is none") {
    std::mt19937 random(3);
    const std::vector<int> values{
        0, 1, -1, 350, std::numeric_limits<int>::min(), std::numeric_limits<int>::max()};
    for (const InputKind kind :
         {InputKind::six_absolute, InputKind::six_relative, InputKind::gamepad, InputKind::mouse}) {
      Device device(kind);
      for (int k = 0; k < 20'000; ++k) {
        const auto any = [&] { return values[random() % values.size()]; };
        if (random() % 50 == 0) device.motion.set_range(random() % 6, {any(), any(), any()});
        device.send(static_cast<int>(random() % 5), static_cast<int>(random() % 12), any());
        if (random() % 4 == 0) device.now += std::chrono::milliseconds(random() % 3000);
        if (random() % 16 == 0) check_pose(device.motion.pose());
      }
    }
  }
}

} // namespace evdev_motion_test
