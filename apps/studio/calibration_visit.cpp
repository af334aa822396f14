#include "studio/calibration_visit.hpp"

#include <chrono>
#include <utility>

#include <nendo/base/text.hpp>

#include "gloves/open_hand.hpp"
#include "studio/waiting.hpp"

namespace nendo::studio {
CalibrationVisit::CalibrationVisit(viewer::SceneWindow& window, std::string glove)
    : name_(std::move(glove)), opening_(std::async(std::launch::async, [name = name_] {
        return driver::open_glove(name, std::nullopt, gloves::glove_context());
      })) {
  window.clear_model();
}

CalibrationVisit::~CalibrationVisit() = default;

Result<Wish> CalibrationVisit::show(viewer::SceneWindow& window) {
  if (!screen_) {
    if (opening_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) {
      show_waiting(window, "Opening " + printable(name_));
      return Wish{};
    }
    auto opened = opening_.get();
    if (!opened) return opened.error();
    glove_ = *std::move(opened);
    screen_ = std::make_unique<CalibrationScreen>(*glove_, calibrate::CalibrationRequest{});
    if (const auto started = screen_->start(); !started) return started.error();
  }
  const auto ended = screen_->show(window);
  if (!ended) return Wish{};
  if (!*ended) return ended->error();
  const CalibrationOutcome& outcome = **ended;
  if (outcome.adapt && outcome.finished) learns_for_ = outcome.finished->wearer.user;
  return Wish{Go{Screen::start}};
}

} // namespace nendo::studio
