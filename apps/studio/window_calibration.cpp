#include "studio/window_calibration.hpp"

#include <utility>

#include "studio/waiting.hpp"

namespace nendo::studio {

WindowCalibration::WindowCalibration(viewer::SceneWindow& window, NamedGlove glove)
    : visit_(std::move(glove)) {
  window.clear_model();
}

Result<Wish> WindowCalibration::show(viewer::SceneWindow& window) {
  if (!screen_) {
    const auto glove = visit_.glove();
    if (!glove) return glove.error();
    if (*glove == nullptr) {
      show_waiting(window, visit_.waiting_words());
      return Wish{};
    }
    screen_ = std::make_unique<CalibrationScreen>(**glove, calibrate::CalibrationRequest{});
    if (const auto started = screen_->start(); !started) return started.error();
  }
  return visit_.follow(screen_->show(window));
}

} // namespace nendo::studio
