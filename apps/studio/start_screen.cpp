#include "studio/start_screen.hpp"

#include <imgui.h>

#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::studio {

using viewer::em;
using viewer::gap_em;

namespace {

constexpr float panel_part = 0.62F; // of the window's width

} // namespace

StartScreen::StartScreen(viewer::SceneWindow& window, const StartOptions& options)
    : choices_(options) {
  window.clear_model(true);
  // About both hands, whether they are there or not.
  window.frame(
      {{-0.24F, 0.0F, 0.0F}, {0.24F, 0.0F, 0.0F}, {0.0F, 0.24F, 0.0F}, {0.0F, -0.16F, 0.0F}},
      {0.0, 12.0});
}

Wish StartScreen::show(viewer::SceneWindow& window) {
  const render::SceneFrame& hands = choices_.update();
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  window.leave_left(static_cast<int>(panel_part * all.x));
  window.leave_below(0);
  window.begin_picture(hands);
  window.move_camera();
  const float gap = em(gap_em), top = window.above_px() + gap;
  const float width = panel_part * all.x - gap, left = width + 2.0F * gap;
  constexpr ImGuiWindowFlags flags = ImGuiWindowFlags_NoCollapse | ImGuiWindowFlags_NoNav;
  viewer::begin_pane("start", {gap, top}, {0.0F, 0.0F}, {width, all.y - top - gap},
                     flags | ImGuiWindowFlags_NoTitleBar);
  Wish wish = choices_.describe_ways(
      ways_, "Or drop one on the window: a model, a puppet, a recording, a timeline.");
  ImGui::End();
  viewer::begin_pane("Your hands", {left, all.y - gap}, {0.0F, 1.0F},
                     {all.x - left - gap, (all.y - top) * 0.45F}, flags);
  const Wish of_hands = choices_.describe_hands(hands_);
  ImGui::End();
  window.end_picture();
  return is_wish(of_hands) ? of_hands : wish;
}

} // namespace nendo::studio
