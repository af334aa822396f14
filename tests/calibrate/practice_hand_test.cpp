// The hand that practises: nendo calibrate can be followed with it to its end.

#include <cmath>
#include <cstdint>
#include <optional>

#include <doctest/doctest.h>

#include <nendo/hand/calibration_fit.hpp>

#include "calibrate/guide.hpp"
#include "calibrate/practice_hand.hpp"
#include "simulated/typical_wearer.hpp"

namespace practice_hand_test {

using namespace nendo;
using namespace nendo::calibrate;

namespace {

/// The practising hand in a typical glove, in front of the guide.
struct Practice {
  PracticeHand hand;
  driver::TypicalWearer glove;
  CalibrationGuide guide;
  double time_s = 0.0;

  explicit Practice(std::uint32_t seed, std::optional<double> hold_s)
      : hand(seed, hold_s), glove(seed), guide(hand::full_takes(), CountScale{}) {}

  /// Up to just before the first pose of a round by time.
  void move_freely() {
    const double end_s = time_s + PracticeHand::free_motion_s - 0.1;
    while (time_s < end_s)
      guide.push_free_motion(next());
    guide.end_free_motion();
  }
  GloveSample next() {
    GloveSample sample;
    sample.raw = glove.counts(hand.at(time_s));
    sample.present = sensors_22;
    time_s += 1.0 / 90.0;
    sample.arrival = sample.measured = HostTime(from_seconds(100.0 + time_s));
    return sample;
  }
};

} // namespace

TEST_SUITE("practice_hand") {
  TEST_CASE("by keys, each pose is taken where it is asked for, and a calibration fits") {
    // Of 4 the thumb's roll once was at an end in a pose; of 48 the thumb's bend was implausible.
    for (const std::uint32_t seed : {1U, 2U, 3U, 4U, 9U, 48U}) {
      CAPTURE(seed);
      Practice practice(seed, {});
      for (int n = 0; n < 900; ++n)
        practice.guide.push_free_motion(practice.next());
      CHECK(practice.hand.step() == 0);
      practice.guide.end_free_motion();
      while (!practice.guide.is_done()) {
        const std::size_t number = practice.guide.number();
        practice.hand.go_on();
        for (int n = 0; n < 4 * 90 && !practice.guide.is_done(); ++n) {
          if (practice.guide.push(practice.next()) == CalibrationGuide::Event::captured) break;
        }
        CAPTURE(hand::pose_of(hand::full_takes()[number]).name);
        REQUIRE((practice.guide.is_done() || practice.guide.number() == number + 1));
        CHECK(practice.hand.in_words(practice.hand.step())
                  .ends_with(hand::pose_of(hand::full_takes()[number]).name));
      }
      CHECK(practice.guide.left_out().bits == 0);
      hand::FitOptions options;
      options.free_motion = practice.guide.free_motion();
      const auto fit =
          hand::fit_calibration(practice.guide.readings(), Side::right, sensors_22, options);
      REQUIRE_MESSAGE(fit, (fit ? "" : fit.error().message));
      // The hand is a stranger's: the fit has found other lines than the default's.
      int other = 0;
      for (std::size_t slot = 0; slot < sensor_slots; ++slot) {
        const double gain = fit->calibration.sensors[slot].gain_rad_per_count;
        const double usual = hand::default_calibration().sensors[slot].gain_rad_per_count;
        if (usual != 0.0 && std::abs(gain / usual - 1.0) > 0.02) ++other;
      }
      CHECK(other > 10);
    }
  }

  TEST_CASE("by time, whatever the seed, each pose is taken while it is held, for 3 s at least") {
    for (std::uint32_t seed = 1; seed <= 60; ++seed) {
      CAPTURE(seed);
      Practice practice(seed, 3.0);
      practice.move_freely();
      int late = 0;
      const double end_s = practice.time_s + 3.0 * practice.hand.pose_count();
      while (practice.time_s < end_s && !practice.guide.is_done()) {
        const auto asked = static_cast<int>(practice.guide.number()) + 1;
        const GloveSample sample = practice.next();
        if (practice.hand.step() > asked) ++late;
        practice.guide.push(sample);
      }
      CHECK(late == 0);
      CHECK(practice.guide.is_done());
      CHECK(practice.guide.left_out().bits == 0);
    }
  }

  TEST_CASE("by time, a wearer who missed a pose can begin again with the hand") {
    Practice practice(1, 3.0);
    practice.move_freely();
    const int poses = practice.hand.pose_count();
    const double round_s = PracticeHand::free_motion_s + 3.0 * poses;
    while (practice.time_s < round_s - 0.1)
      practice.next();
    CHECK(practice.hand.step() == poses);
    practice.guide.reset();
    while (practice.time_s < round_s)
      practice.next();
    practice.move_freely();
    CHECK(practice.hand.step() == 0);
    CHECK(practice.hand.in_words(0) == "bends and stretches every joint");
    while (practice.time_s < 2.0 * round_s && !practice.guide.is_done())
      practice.guide.push(practice.next());
    CHECK(practice.guide.is_done());
  }

  TEST_CASE("it goes back as it went ahead, and never beyond the first or the last") {
    PracticeHand hand(1, {});
    hand.go_on();
    hand.go_on();
    hand.at(1.0);
    CHECK(hand.step() == 2);
    hand.go_back();
    hand.at(2.0);
    CHECK(hand.step() == 1);
    for (int n = 0; n < 100; ++n)
      hand.go_back();
    hand.at(3.0);
    CHECK(hand.step() == 0);
    for (int n = 0; n < 300; ++n)
      hand.go_on();
    hand.at(4.0);
    CHECK(hand.step() == hand.pose_count() + 1);
    CHECK(hand.in_words(hand.step()) == "every pose was held; it moves freely");
  }
}

} // namespace practice_hand_test
