#include "viewer/hints.hpp"

#include <imgui.h>

#include "commands/commands.hpp"
#include "viewer/controls.hpp"
#include "viewer/theme.hpp"

namespace nendo::viewer {

bool draw_hints(int covered_px, float below_px) {
  const float left = static_cast<float>(covered_px);
  const float middle = (left + ImGui::GetIO().DisplaySize.x) / 2.0F;
  const float bottom = ImGui::GetIO().DisplaySize.y - below_px - em(gap_em);
  ImGui::SetNextWindowPos(ImVec2(middle, bottom), ImGuiCond_Always, ImVec2(0.5F, 1.0F));
  ImGui::Begin("hints", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
  for (const auto& [keys, text] : commands::hints) {
    ImGui::TextColored(accent(), "%s", keys.data());
    ImGui::SameLine(em(4.0F));
    ImGui::TextUnformatted(text.data());
  }
  ImGui::TextDisabled("F3 finds any command, ? lists the keys.");
  ImGui::SameLine();
  const bool is_done = button("Do not show again");
  show_text("Closes these hints for good.");
  ImGui::End();
  return is_done;
}

} // namespace nendo::viewer
