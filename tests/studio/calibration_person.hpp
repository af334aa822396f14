#pragma once
// A person before the window of a calibration, in a glove whose samples the test makes.

#include <algorithm>
#include <chrono>
#include <memory>
#include <optional>
#include <string>

#include <doctest/doctest.h>

#include "reference/wearers.hpp"
#include "studio/calibration_screen.hpp"
#include "support/open_window.hpp"
#include "viewer/controls.hpp"

namespace nendo::test {

/// A glove that sends what push() is given.
class PushedGlove final : public driver::Glove {
public:
  explicit PushedGlove(Side side) {
    info_.source = "test";
    info_.model = "CyberGlove, 22 sensors";
    info_.side = side;
    info_.sensors = sensors_22;
    info_.rate_hz = 90.0;
  }
  void push(GloveSample sample) {
    sample.side = info_.side;
    if (ring_ != nullptr) REQUIRE(ring_->try_push(sample));
  }
  const driver::GloveInfo& info() const noexcept override { return info_; }
  Result<void> start(SampleRing& ring) override {
    ring_ = &ring;
    return {};
  }
  void stop() noexcept override { ring_ = nullptr; }
  driver::StreamStats stats() const noexcept override { return {}; }
  void set_feedback(const driver::Feedback&) noexcept override {}

private:
  driver::GloveInfo info_;
  SampleRing* ring_ = nullptr;
};

/// A mouse before a screen.
struct Visitor {
  std::shared_ptr<viewer::SceneWindow> window;
  std::optional<studio::CalibrationScreen> screen;
  std::optional<Result<studio::CalibrationOutcome>> outcome;

  explicit Visitor(const viewer::WindowLook& look) { window = test::open_window(look); }
  void look(int pictures = 1) {
    for (int picture = 0; picture < pictures && !outcome; ++picture)
      outcome = screen->show(*window);
  }
  static const viewer::Control* find(const std::string& name) {
    for (const viewer::Control& control : viewer::controls())
      if (control.name == name) return &control;
    return nullptr;
  }
  /// Shows pictures until there is a control of this name.
  bool waits_for(const std::string& name, std::chrono::seconds longest = std::chrono::seconds(20)) {
    const HostTime end = HostClock::now() + longest;
    do
      look();
    while (find(name) == nullptr && !outcome && HostClock::now() < end);
    return find(name) != nullptr;
  }
  void give(const viewer::SimulatedInput& input) {
    window->simulate(input);
    look();
    window->simulate({});
    look();
  }
  void press(const std::string& name) {
    const viewer::Control* const control = find(name);
    REQUIRE_MESSAGE(control != nullptr, name);
    const Eigen::Vector2f middle = (control->min + control->max) / 2.0F;
    viewer::SimulatedInput input;
    input.pointer = middle.cast<double>();
    for (const bool down : {false, true, false}) { // a button is pressed where the pointer was
      input.buttons[0] = down;
      window->simulate(input);
      look();
    }
    window->simulate({});
    look();
  }
  void type(const std::u32string& text) {
    for (const char32_t letter : text) {
      viewer::SimulatedInput input;
      input.text = {letter};
      give(input);
    }
  }
  void type_key(int key) {
    viewer::SimulatedInput input;
    input.taps = {key};
    give(input);
  }
};

/// A wearer whose true joints are known.
struct Person : Visitor {
  reference::Wearer wearer;
  PushedGlove glove;
  double time_s;

  explicit Person(std::uint64_t seed = 2002,
                  const viewer::WindowLook& look = {{800, 600}, viewer::Theme::light, 1.0F},
                  calibrate::CalibrationRequest request = {})
      : Visitor(look), wearer(seed), glove(wearer.side()),
        time_s(to_seconds(HostClock::now().time_since_epoch())) {
    screen.emplace(glove, std::move(request));
    REQUIRE(screen->start());
  }
  ~Person() { screen.reset(); } // before the glove
  /// Holds these angles, and shows a picture each half second of the glove's time.
  void hold(const hand::SensorAngles& angles, double seconds) {
    for (int n = 0; n < static_cast<int>(seconds * 90.0); ++n) {
      push(angles);
      if (n % 45 == 44) look();
    }
    look();
  }
  void push(const hand::SensorAngles& angles) {
    GloveSample sample = wearer.read(angles);
    time_s = std::max(time_s, to_seconds(HostClock::now().time_since_epoch()));
    time_s += 1.0 / 90.0;
    sample.arrival = sample.measured = HostTime(from_seconds(time_s));
    glove.push(sample);
  }
  /// Goes to a pose of the wearer, and holds it.
  void take(hand::PoseId pose, double seconds = 1.4) { hold(wearer.perform(pose), seconds); }
  void move_freely(double seconds = 12.0) {
    const reference::FreeMotion motion(1, wearer.ranges());
    for (int n = 0; n < static_cast<int>(seconds * 90.0); ++n) {
      push(motion.angles_rad(n / 90.0));
      if (n % 90 == 89) look();
    }
  }
  /// From the first picture to the first pose.
  void begin(const std::string& kind) {
    take(hand::PoseId::flat, 0.3);
    look(2); // a new panel finds its size first
    press(kind);
    press("Start");
    move_freely();
    press("Begin");
  }
};

} // namespace nendo::test
