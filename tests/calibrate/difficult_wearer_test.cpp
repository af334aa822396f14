// The guide, followed to the letter by wearers who are late, fidget, misread a pose, have a stiff
// thumb, and take a break.

#include <algorithm>
#include <array>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include <doctest/doctest.h>

#include <nendo/hand/calibration_fit.hpp>

#include "calibrate/guide.hpp"
#include "reference/wearers.hpp"

namespace difficult_wearer_test {

using namespace nendo;
using namespace nendo::calibrate;
using hand::PoseId;
using hand::SensorAngles;
using Event = CalibrationGuide::Event;

namespace {

constexpr double rate_hz = 90.0;

struct Habits {
  double late_s = 0.0;      ///< until what is asked for is begun, at most
  double tremor_rad = 0.0;  ///< while a pose is held
  double fidget_rad = 0.0;  ///< a finger that moves on after the hand came to rest
  int misread = -1;         ///< the number of a pose that is taken for the next one
  int break_before = -1;    ///< the number of a pose before which the hand rests for long
  double thumb_reach = 1.0; ///< the part of the thumb's way that the wearer can go
};

bool is_of_thumb(std::size_t slot) {
  const auto sensor = static_cast<Sensor>(slot);
  return sensor == Sensor::thumb_roll || sensor == Sensor::thumb_mcp ||
         sensor == Sensor::thumb_ip || sensor == Sensor::thumb_abduction;
}

Habits difficult(std::uint64_t seed) {
  const auto number = static_cast<int>(seed);
  return {.late_s = 5.0,
          .tremor_rad = 0.006,
          .fidget_rad = 0.1,
          .misread = number % 22 + 1,
          .break_before = 7 * number % 22 + 1};
}

struct Spread {
  double median, p95; ///< degrees
};
Spread spread_of(std::vector<double>& errors) {
  std::sort(errors.begin(), errors.end());
  return {errors[errors.size() / 2], errors[errors.size() * 95 / 100]};
}
struct Errors {
  Spread fingers, thumb;
};

/// A person in front of the guide, who knows no more than it shows.
class Person {
public:
  Person(std::uint64_t seed, const Habits& habits, SensorMask stiff = {})
      : seed_(seed), habits_(habits), stiff_(stiff), wearer_(seed), random_(seed),
        flat_(wearer_.perform(PoseId::flat)), guide_(hand::full_poses(), CountScale{}, stiff),
        now_(flat_) {}

  /// Follows the guide to its end. Returns false if it does not come to one.
  bool follow() {
    while (!guide_.is_done() && time_s_ < 1800.0)
      do_what_is_asked();
    return guide_.is_done();
  }
  Result<hand::CalibrationFit> fitted() const {
    hand::FitOptions options;
    options.stiff = stiff_;
    options.hold_out = false;
    return hand::fit_calibration(guide_.readings(), wearer_.side(), sensors_22, options);
  }
  /// Of the angles while this person moves freely, as far as the thumb can.
  Errors errors(const hand::Calibration& calibration) const {
    reference::Wearer moving(seed_);
    const reference::FreeMotion motion(seed_, moving.ranges());
    std::vector<double> fingers, thumb;
    for (int moment = 0; moment < 300; ++moment) {
      const SensorAngles angles = stiff(motion.angles_rad(0.1 * moment));
      const SensorAngles seen = calibration.angles_rad(moving.read(angles));
      for (std::size_t slot = 0; slot < sensor_slots; ++slot)
        if (sensors_22.has(static_cast<Sensor>(slot)))
          (is_of_thumb(slot) ? thumb : fingers)
              .push_back(to_degrees(std::abs(seen[slot] - angles[slot])));
    }
    return {spread_of(fingers), spread_of(thumb)};
  }
  double minutes() const { return time_s_ / 60.0; }
  int began_again() const { return began_again_; }

private:
  void do_what_is_asked() {
    const auto number = static_cast<int>(guide_.number());
    if (!stay(uniform(0.3 * habits_.late_s, habits_.late_s), number)) return;
    if (number == habits_.break_before && !had_break_) {
      had_break_ = true;
      go(relaxed(), 1.0);
      if (!stay(25.0, number)) return;
    }
    const bool misreads = number == habits_.misread && !has_misread_;
    has_misread_ = has_misread_ || misreads;
    const PoseId asked = guide_.asked();
    const PoseId done = misreads ? hand::full_poses()[static_cast<std::size_t>(number) + 1] : asked;
    go(stiff(wearer_.perform(done)), uniform(0.5, 1.2));
    Event event = hold(uniform(0.3, 0.8));
    if (event == Event::none) {
      fidget();
      event = hold(8.0);
    }
    if (event == Event::captured && misreads)
      guide_.go_back(); // the next picture shows what was meant
    if (event != Event::none) return;
    ++began_again_; // whatever the guide says
    go(relaxed(), 0.7);
  }
  /// Does nothing for a while. False if the guide took that for the pose, and one had to go back.
  bool stay(double seconds, int number) {
    hold(seconds);
    if (static_cast<int>(guide_.number()) == number) return true;
    guide_.go_back();
    return false;
  }
  void fidget() {
    SensorAngles to = now_;
    to[static_cast<std::size_t>(uniform(0.0, 22.0))] += uniform(-1.0, 1.0) * habits_.fidget_rad;
    go(to, 0.2);
  }
  void go(const SensorAngles& to, double seconds) {
    const SensorAngles from = now_;
    const int steps = std::max(1, static_cast<int>(seconds * rate_hz));
    for (int step = 1; step <= steps; ++step) {
      for (std::size_t slot = 0; slot < sensor_slots; ++slot)
        now_[slot] = from[slot] + (to[slot] - from[slot]) * step / steps;
      push();
    }
  }
  /// Until something happens.
  Event hold(double seconds) {
    for (double end = time_s_ + seconds; time_s_ < end;)
      if (const Event event = push(); event != Event::none) return event;
    return Event::none;
  }
  Event push() {
    time_s_ += 1.0 / rate_hz;
    SensorAngles shown = now_;
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      shown[slot] += habits_.tremor_rad * std::sin(50.0 * time_s_ + static_cast<double>(slot));
    GloveSample sample = wearer_.read(shown);
    sample.side = wearer_.side();
    sample.arrival = sample.measured = HostTime(from_seconds(time_s_));
    return guide_.push(sample);
  }
  SensorAngles relaxed() const {
    SensorAngles angles = flat_;
    for (const Sensor sensor :
         {Sensor::index_mcp, Sensor::middle_mcp, Sensor::ring_mcp, Sensor::little_mcp,
          Sensor::index_pip, Sensor::middle_pip, Sensor::ring_pip, Sensor::little_pip})
      angles[static_cast<std::size_t>(sensor)] += 0.5;
    return stiff(angles);
  }
  SensorAngles stiff(SensorAngles angles) const {
    for (std::size_t slot = 0; slot < sensor_slots; ++slot)
      if (is_of_thumb(slot))
        angles[slot] = flat_[slot] + habits_.thumb_reach * (angles[slot] - flat_[slot]);
    return angles;
  }
  double uniform(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random_);
  }

  std::uint64_t seed_;
  Habits habits_;
  SensorMask stiff_;
  reference::Wearer wearer_;
  std::mt19937_64 random_;
  SensorAngles flat_;
  CalibrationGuide guide_;
  SensorAngles now_;
  double time_s_ = 10.0;
  bool had_break_ = false, has_misread_ = false;
  int began_again_ = 0; ///< from a relaxed hand, because nothing came of a pose
};

} // namespace

TEST_SUITE("difficult_wearer") {
  TEST_CASE("who is late, fidgets, misreads a pose and takes a break comes to the end") {
    for (std::uint64_t seed = 4001; seed <= 4008; ++seed) {
      CAPTURE(seed);
      Person person(seed, difficult(seed));
      REQUIRE(person.follow());
      CHECK(person.minutes() < 5.0);
      CHECK(person.began_again() <= 5);
      const auto fit = person.fitted();
      REQUIRE_MESSAGE(fit, fit.error().message);
      const Errors errors = person.errors(fit->calibration);
      CHECK(errors.fingers.median < 3.0);
      CHECK(errors.fingers.p95 < 12.0);
      CHECK(errors.thumb.median < 5.0);
      CHECK(errors.thumb.p95 < 15.0);
      CHECK(fit->outliers.size() <= 2);
      CHECK(fit->limited_range == std::array<bool, hand::finger_count>{});
    }
  }

  TEST_CASE("a stiff thumb is noticed, and with --stiff, only its flat hand is used") {
    int noticed = 0;
    for (std::uint64_t seed = 4001; seed <= 4008; ++seed) {
      CAPTURE(seed);
      Habits habits = difficult(seed);
      habits.thumb_reach = 0.5;
      Person unknowing(seed, habits);
      REQUIRE(unknowing.follow());
      const auto believed = unknowing.fitted();
      REQUIRE_MESSAGE(believed, believed.error().message);
      noticed += believed->limited_range[0] ? 1 : 0;
      for (std::size_t finger = 1; finger < hand::finger_count; ++finger)
        CHECK_FALSE(believed->limited_range[finger]);

      Person stated(seed, habits, hand::sensors_of(hand::Finger::thumb));
      REQUIRE(stated.follow());
      const auto fit = stated.fitted();
      REQUIRE_MESSAGE(fit, fit.error().message);
      const Errors before = unknowing.errors(believed->calibration);
      const Errors errors = stated.errors(fit->calibration);
      CHECK(errors.thumb.p95 < 0.6 * before.thumb.p95);
      CHECK(errors.thumb.median < 7.0);
      CHECK(errors.fingers.median < 3.0);
      CHECK(fit->calibration[Sensor::thumb_mcp].gain_rad_per_count ==
            hand::default_calibration()[Sensor::thumb_mcp].gain_rad_per_count);
    }
    CHECK(noticed >= 7);
  }

  TEST_CASE("no other wearer is taken for one with a stiff finger") {
    for (std::uint64_t seed = 4101; seed <= 4140; ++seed) {
      CAPTURE(seed);
      Person person(seed, {});
      REQUIRE(person.follow());
      CHECK(person.fitted()->limited_range == std::array<bool, hand::finger_count>{});
    }
  }
}

} // namespace difficult_wearer_test
