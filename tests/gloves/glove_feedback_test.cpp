#include "gloves/glove_feedback.hpp"

#include <vector>

#include <doctest/doctest.h>

namespace glove_feedback_test {

using namespace nendo;
using nendo::gloves::GloveFeedback;

namespace {

class GloveWithDiary final : public driver::Glove {
public:
  explicit GloveWithDiary(bool light, bool vibration = false, bool resistance = false) {
    info_.abilities.light = light;
    info_.abilities.vibration = vibration;
    info_.abilities.resistance = resistance;
  }
  const driver::GloveInfo& info() const noexcept override { return info_; }
  Result<void> start(SampleRing& /*ring*/) override { return {}; }
  void stop() noexcept override {}
  driver::StreamStats stats() const noexcept override { return {}; }
  void set_feedback(const driver::Feedback& feedback) noexcept override {
    given.push_back(feedback.light);
    latest = feedback;
  }

  std::vector<bool> given;
  driver::Feedback latest;

private:
  driver::GloveInfo info_;
};

} // namespace

TEST_SUITE("glove_feedback") {
  TEST_CASE("the glove is notified of changes only, and left dark") {
    GloveWithDiary glove(true);
    GloveFeedback light(glove);
    for (const bool lit : {false, true, true, false, true})
      light.show(lit);
    CHECK(light.is_lit());
    light.put_out();
    light.put_out();
    CHECK(glove.given == std::vector<bool>{true, false, true, false});
  }

  TEST_CASE("a glove without a light is left alone") {
    GloveWithDiary glove(false);
    GloveFeedback light(glove);
    light.show(true);
    CHECK_FALSE(light.is_lit());
    light.put_out();
    CHECK(glove.given.empty());
  }

  TEST_CASE("a touch is felt at once, the harder the more, and its end, too") {
    for (const bool vibrates : {true, false}) {
      GloveWithDiary glove(false, vibrates, !vibrates);
      GloveFeedback feedback(glove);
      HostTime now = HostClock::now();
      int before = 0;
      for (const float strength : {0.01F, 0.3F, 0.7F, 1.0F}) {
        now += GloveFeedback::vibration_period;
        feedback.feel({0.0F, strength, 0.0F, 0.0F, 0.0F, strength}, now);
        const int felt = vibrates ? glove.latest.vibration[1] : glove.latest.resistance[1];
        CHECK(felt > before);
        before = felt;
        CHECK(glove.latest.vibration[0] == 0);
        CHECK(glove.latest.resistance[0] == 0);
        CHECK((glove.latest.vibration[5] > 0) == vibrates); // the palm has no brake
      }
      CHECK(before == (vibrates ? 255 : 1000));
      now += GloveFeedback::vibration_period;
      feedback.feel({}, now);
      CHECK(glove.latest == driver::Feedback{});
      CHECK(glove.given.size() == 5);
    }
  }

  TEST_CASE("a CyberTouch's stream is paused ten times a second at most, and the newest counts") {
    GloveWithDiary glove(true, true);
    GloveFeedback feedback(glove);
    const HostTime begin = HostClock::now();
    for (int ms = 0; ms < 1000; ++ms)
      feedback.feel({static_cast<float>(ms % 50) / 50.0F, 0.5F},
                    begin + std::chrono::milliseconds(ms));
    CHECK(glove.given.size() <= 10);
    CHECK(glove.given.size() >= 5);
    feedback.feel({}, begin + std::chrono::milliseconds(1100));
    CHECK(glove.latest == driver::Feedback{});
  }

  TEST_CASE("light and touch do not put each other out, and the end puts out both") {
    GloveWithDiary glove(true, true);
    GloveFeedback feedback(glove);
    feedback.show(true);
    feedback.feel({1.0F});
    CHECK(glove.latest.light);
    CHECK(glove.latest.vibration[0] == 255);
    feedback.show(false);
    CHECK(glove.latest.vibration[0] == 255);
    feedback.put_out();
    CHECK(glove.latest == driver::Feedback{});
  }

  TEST_CASE("a glove that can do nothing is not asked to") {
    GloveWithDiary glove(false);
    GloveFeedback feedback(glove);
    feedback.feel({1.0F, 1.0F, 1.0F, 1.0F, 1.0F, 1.0F});
    CHECK(glove.given.empty());
  }
}

} // namespace glove_feedback_test
