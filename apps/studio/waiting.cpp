#include "studio/waiting.hpp"

#include <imgui.h>

#include "viewer/controls.hpp"
#include "viewer/widgets.hpp"

namespace nendo::studio {

bool show_waiting(viewer::SceneWindow& window, const std::string& text, const std::string& button) {
  window.leave_left(0);
  window.leave_below(0);
  window.begin_picture({}, false);
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  viewer::begin_pane("waiting", {all.x / 2.0F, all.y / 2.0F}, {0.5F, 0.5F}, {0.0F, 0.0F},
                     ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoNav);
  ImGui::TextUnformatted(text.c_str());
  const bool is_pressed = !button.empty() && viewer::button(button);
  ImGui::End();
  window.end_picture();
  return is_pressed;
}

} // namespace nendo::studio
