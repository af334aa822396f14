#include "studio/calibration_visit.hpp"

#include <chrono>
#include <utility>

#include <imgui.h>

#include <nendo/base/text.hpp>

#include "gloves/open_hand.hpp"

namespace nendo::studio {
namespace {

/// A picture that says what the user waits for.
void show_waiting(viewer::SceneWindow& window, const std::string& what) {
  window.leave_left(0);
  window.leave_below(0);
  window.begin_picture({}, false);
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos({all.x / 2.0F, all.y / 2.0F}, ImGuiCond_Always, {0.5F, 0.5F});
  ImGui::Begin("waiting", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_AlwaysAutoResize |
                   ImGuiWindowFlags_NoNav | ImGuiWindowFlags_NoFocusOnAppearing);
  ImGui::Text("Opening %s", printable(what).c_str());
  ImGui::End();
  window.end_picture();
}

} // namespace

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
      show_waiting(window, name_);
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
