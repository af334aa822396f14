#include "studio/window_calibration.hpp"

#include <utility>

#include "studio/waiting.hpp"

namespace nendo::studio {

WindowCalibration::WindowCalibration(viewer::SceneWindow& window, Bar& bar, NamedGlove glove)
    : bar_(bar), visit_(std::move(glove)) {
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

bool WindowCalibration::lets(const Wish& wish) {
  if (!is_wish(wish) || !screen_ || !screen_->has_unkept_poses()) return true;
  waiting_ = wish;
  bar_.ask_to_discard("the poses");
  return false;
}

Wish WindowCalibration::take_settled() {
  if (!is_wish(waiting_)) return {};
  const auto answer = bar_.take_answer();
  if (!answer) return {};
  const Wish wish = std::exchange(waiting_, {});
  return *answer == Answer::discard ? wish : Wish{};
}

} // namespace nendo::studio
