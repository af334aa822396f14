#include "studio/calibration_visit.hpp"

#include <chrono>
#include <utility>

#include <nendo/base/text.hpp>

#include "gloves/open_hand.hpp"

namespace nendo::studio {

CalibrationVisit::CalibrationVisit(NamedGlove glove)
    : name_(glove.spec), opening_(std::async(std::launch::async, [glove = std::move(glove)] {
        return driver::open_glove(glove.spec, glove.side, gloves::glove_context());
      })) {}

Result<driver::Glove*> CalibrationVisit::glove() {
  if (!glove_) {
    if (opening_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return nullptr;
    auto opened = opening_.get();
    if (!opened) return opened.error();
    glove_ = *std::move(opened);
  }
  return glove_.get();
}

std::string CalibrationVisit::waiting_words() const {
  return "Opening " + printable(name_);
}

Result<Wish> CalibrationVisit::follow(const std::optional<Result<CalibrationOutcome>>& outcome) {
  if (!outcome) return Wish{};
  if (!*outcome) return outcome->error();
  const CalibrationOutcome& done = **outcome;
  if (done.adapt && done.finished) learns_for_ = done.finished->wearer.user;
  return Wish{Go{Screen::start}};
}

} // namespace nendo::studio
