// The guided calibration without terminal or window, and the advice that it gives.

#include <algorithm>
#include <bit>
#include <chrono>
#include <cmath>
#include <string>

#include <doctest/doctest.h>

#include "calibrate/findings.hpp"
#include "calibrate/guided_calibration.hpp"
#include "calibrate/pose_advice.hpp"
#include "reference/wearers.hpp"

namespace guided_calibration_test {

using namespace nendo;
using namespace nendo::calibrate;
using hand::PoseId;

namespace {

/// A wearer who is guided.
struct Guided {
  reference::Wearer wearer;
  driver::GloveInfo info;
  CalibrationGuide guide;
  GuidedCalibration guided;
  double time_s = 10.0;

  Guided(std::uint64_t seed, std::span<const PoseId> poses, hand::FitMode mode)
      : wearer(seed), info(info_of(wearer)), guide(poses, CountScale{}),
        guided(info, options_of(mode), guide) {}
  static driver::GloveInfo info_of(const reference::Wearer& wearer) {
    driver::GloveInfo info;
    info.side = wearer.side();
    info.sensors = sensors_22;
    return info;
  }
  static hand::FitOptions options_of(hand::FitMode mode) {
    hand::FitOptions options;
    options.mode = mode;
    return options;
  }
  void push(const hand::SensorAngles& angles) {
    GloveSample sample = wearer.read(angles);
    time_s += 1.0 / 90.0;
    sample.arrival = sample.measured = HostTime(from_seconds(time_s));
    guided.push(sample);
  }
  void move_freely() {
    const reference::FreeMotion motion(1, wearer.ranges());
    for (int n = 0; n < 1080; ++n)
      push(motion.angles_rad(n / 90.0));
  }
  void hold(const hand::SensorAngles& angles) {
    for (int n = 0; n < 130 && !guide.is_done(); ++n)
      push(angles);
    guided.settle();
  }
  void take(PoseId pose) { hold(wearer.perform(pose)); }
  std::vector<PoseAdvice> advice(const hand::SensorAngles& angles) {
    const GloveSample sample = wearer.read(angles);
    return advise(guide.asked(), hand::joint_angles(sample, guided.calibration()),
                  hand::HandSkeleton(wearer.side()), sample.present,
                  guided.is_fitted() ? Trust::fitted : Trust::typical);
  }
};

} // namespace

TEST_SUITE("guided_calibration") {
  TEST_CASE("it ends when all poses are taken, and no call but settle() waits for a fit") {
    Guided test(2002, hand::full_takes(), hand::FitMode::full);
    test.guided.settle();
    CHECK(test.guided.undetermined() == SensorMask{}); // it has not begun
    test.move_freely();
    test.guided.act(GuideAction::begin);
    test.guided.settle();
    CHECK(test.guided.undetermined() == sensors_22);
    CHECK_FALSE(test.guided.is_fitted());
    HostClock::duration longest{};
    for (const PoseId pose : hand::full_takes()) {
      const auto angles = test.wearer.perform(pose);
      for (int n = 0; n < 130 && !test.guide.is_done(); ++n)
        test.push(angles);
      const HostTime begin = HostClock::now();
      test.guided.update();
      longest = std::max(longest, HostClock::now() - begin);
    }
    CHECK(longest < std::chrono::milliseconds(50));
    CHECK(test.guide.is_done());
    CHECK_FALSE(test.guided.end());
    CHECK(test.guided.is_ending());
    test.guided.act(GuideAction::back); // too late
    test.guided.settle();
    REQUIRE(test.guided.end());
    CHECK(*test.guided.end() == GuideEnd::complete);
    CHECK(test.guided.is_fitted());
    CHECK(std::popcount(test.guided.undetermined().bits) <= 2);
    test.guided.ask_for(3);
    CHECK_FALSE(test.guided.end());
    CHECK(test.guide.number() == 3);
    CHECK(test.guide.asked() == hand::full_takes()[3]);
  }

  TEST_CASE("before a fit, free motion and flat hand give angles that are this wearer's") {
    for (const std::uint64_t seed : {2002U, 2003U, 2004U, 2005U}) {
      CAPTURE(seed);
      Guided test(seed, hand::quick_poses(), hand::FitMode::quick);
      test.move_freely();
      test.guided.act(GuideAction::begin);
      test.take(PoseId::flat);
      REQUIRE(test.guide.number() == 1);
      const hand::SensorAngles half = [] {
        hand::SensorAngles angles{};
        for (const auto& finger : finger_sensors)
          angles[index_of(finger[0])] = angles[index_of(finger[1])] = from_degrees(45.0);
        return angles;
      }();
      const GloveSample sample = test.wearer.read(half);
      const auto angles = test.guided.calibration().angles_rad(sample);
      for (const auto& finger : finger_sensors)
        for (const Sensor sensor : {finger[0], finger[1]})
          CHECK(std::abs(angles[index_of(sensor)] - from_degrees(45.0)) < from_degrees(22.0));
    }
  }

  TEST_CASE("a restart needs to be asked for twice in a row, and forgets the fit") {
    Guided test(2002, hand::touch_up_poses(), hand::FitMode::full);
    test.guided.act(GuideAction::begin);
    test.take(PoseId::flat);
    test.take(PoseId::fist);
    CHECK(test.guided.is_fitted());
    test.guided.act(GuideAction::restart);
    CHECK(test.guided.notice().kind == GuideNotice::Kind::will_restart);
    test.guided.act(GuideAction::take_more); // something else was meant
    test.guided.act(GuideAction::restart);
    CHECK(test.guide.has_any());
    test.guided.act(GuideAction::restart);
    CHECK_FALSE(test.guide.has_any());
    CHECK_FALSE(test.guided.has_begun());
    CHECK_FALSE(test.guided.is_fitted());
  }

  TEST_CASE("poses that no calibration fits are no end, and the last one is asked for again") {
    Guided test(2002, hand::quick_poses(), hand::FitMode::quick);
    test.guided.act(GuideAction::begin);
    test.take(PoseId::flat);
    test.guided.act(GuideAction::finish);
    test.guided.settle();
    CHECK_FALSE(test.guided.end());
    CHECK(test.guided.notice().kind == GuideNotice::Kind::unfitted);
    CHECK(test.guided.notice().text.find("fist") != std::string::npos);
    CHECK(test.guide.asked() == PoseId::fist);
  }

  TEST_CASE("advice names the finger that is off and the way, and rarely one of a good pose") {
    int poses = 0, alarms = 0;
    for (const std::uint64_t seed : {2002U, 2003U, 2004U, 2005U, 2006U, 2007U}) {
      Guided test(seed, hand::full_poses(), hand::FitMode::full);
      test.move_freely();
      test.guided.act(GuideAction::begin);
      while (!test.guide.is_done()) {
        const PoseId pose = test.guide.asked();
        const auto angles = test.wearer.perform(pose);
        ++poses;
        if (const auto advice = test.advice(angles); !advice.empty()) {
          ++alarms;
          MESSAGE(seed << ' ' << hand::pose_of(pose).name << ": " << advice.front().text);
        }
        test.hold(angles);
        if (!test.guide.is_done() && test.guide.asked() == pose) test.guided.act(GuideAction::skip);
      }
    }
    CHECK(alarms < poses / 10);

    Guided test(2002, hand::full_poses(), hand::FitMode::full);
    test.move_freely();
    test.guided.act(GuideAction::begin);
    test.take(PoseId::flat);
    test.take(PoseId::fist);
    REQUIRE(test.guide.asked() == PoseId::spread);
    auto angles = test.wearer.perform(PoseId::spread);
    angles[index_of(Sensor::ring_pip)] = from_degrees(70.0);
    auto advice = test.advice(angles);
    REQUIRE(advice.size() == 1);
    CHECK(advice[0].text == "ring finger: straighten it at the middle joint");
    CHECK(advice[0].fingers == std::array{false, false, false, true, false});
    advice = test.advice(test.wearer.perform(PoseId::fist));
    REQUIRE_FALSE(advice.empty());
    CHECK(advice[0].text == "fingers: straighten them");
    while (test.guide.asked() != PoseId::wrist_down)
      test.guided.act(GuideAction::skip);
    advice = test.advice(test.wearer.perform(PoseId::wrist_back));
    REQUIRE_FALSE(advice.empty());
    CHECK(advice[0].text == "wrist: bend it towards the palm");
  }

  TEST_CASE("what is not sure is named, with what to do") {
    Guided test(2004, hand::quick_poses(), hand::FitMode::quick);
    test.guided.act(GuideAction::begin);
    test.take(PoseId::flat);
    test.take(PoseId::fist);
    CalibrationRequest request;
    request.user = "anna";
    request.kind = CalibrationKind::quick;
    request.out = "unwritten.toml";
    const auto file = WearerFile::find(request, calibrated_glove(test.info));
    REQUIRE(file);
    const auto finished = file->fit(test.guide);
    REQUIRE_MESSAGE(finished, (finished ? "" : finished.error().message));
    CHECK(certainty_of(*finished, Sensor::ring_little_abduction) == Certainty::average);
    CHECK(certainty_of(*finished, Sensor::ring_mcp) != Certainty::average);
    const auto found = findings(*finished, request.kind);
    REQUIRE_FALSE(found.empty());
    CHECK(found[0].text.find("gap of ring and little finger") != std::string::npos);
    CHECK(found[0].remedy.find("full calibration") != std::string::npos);
    CHECK(worst_reading(*finished) < 2);
  }
}

} // namespace guided_calibration_test
