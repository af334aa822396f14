#pragma once
// A person before the studio's window, with a mouse and a keyboard that the test simulates.

#include <functional>
#include <memory>
#include <string>

#include <doctest/doctest.h>

#include "support/open_window.hpp"
#include "viewer/controls.hpp"

namespace nendo::test {

struct StudioSeat {
  std::shared_ptr<viewer::SceneWindow> window;
  std::function<void()> show; ///< draws a picture

  explicit StudioSeat(const viewer::WindowLook& look = {{1280, 800}, viewer::Theme::light, 1.0F}) {
    window = test::open_window(look);
  }

  const viewer::Control* control(const std::string& name) const {
    for (const viewer::Control& one : viewer::controls())
      if (one.name == name) return &one;
    return nullptr;
  }
  bool sees(const std::string& name) const { return control(name) != nullptr; }
  void point(const Eigen::Vector2d& at, bool pressed) {
    viewer::SimulatedInput input;
    input.pointer = at;
    input.buttons[0] = pressed;
    window->simulate(input);
    show();
  }
  /// Clicks the control, which must be there and possible.
  void press(const std::string& name) {
    const viewer::Control* const found = control(name);
    REQUIRE_MESSAGE(found != nullptr, name);
    REQUIRE_MESSAGE(found->is_possible, name);
    press(*found);
  }
  void press(const viewer::Control& found) {
    const Eigen::Vector2d middle = ((found.min + found.max) / 2.0F).cast<double>();
    for (const bool pressed : {false, true, false})
      point(middle, pressed);
    show();
  }
  void key(int key, bool control = false, bool shift = false) {
    viewer::SimulatedInput input;
    input.taps = {key};
    input.control = control;
    input.shift = shift;
    window->simulate(input);
    show();
    window->simulate({});
    show();
  }
  void type(const std::string& text) {
    viewer::SimulatedInput input;
    input.text.assign(text.begin(), text.end());
    window->simulate(input);
    show();
    window->simulate({});
    show();
  }
};

} // namespace nendo::test
