#include "viewer/hints.hpp"

#include <array>

#include <imgui.h>

#include "viewer/controls.hpp"
#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

struct Hint {
  const char* keys;
  const char* text;
};
constexpr std::array hints{
    Hint{"g, l", "The hands grab the model, and release it."},
    Hint{"u, r", "Undo and redo; a click in the history goes to any step."},
    Hint{"drag", "Turns the view; with shift it shifts it, and the wheel zooms."},
};

} // namespace

bool draw_hints(int covered_px, float below_px) {
  const float left = static_cast<float>(covered_px);
  const float middle = (left + ImGui::GetIO().DisplaySize.x) / 2.0F;
  const float bottom = ImGui::GetIO().DisplaySize.y - below_px - em(gap_em);
  ImGui::SetNextWindowPos(ImVec2(middle, bottom), ImGuiCond_Always, ImVec2(0.5F, 1.0F));
  ImGui::Begin("hints", nullptr,
               ImGuiWindowFlags_NoDecoration | ImGuiWindowFlags_NoMove |
                   ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoSavedSettings |
                   ImGuiWindowFlags_NoFocusOnAppearing | ImGuiWindowFlags_NoNav);
  for (const Hint& hint : hints) {
    ImGui::TextColored(accent(), "%s", hint.keys);
    ImGui::SameLine(em(4.0F));
    ImGui::TextUnformatted(hint.text);
  }
  ImGui::TextDisabled("F3 finds any command, ? lists the keys.");
  ImGui::SameLine();
  const bool is_done = button("Do not show again");
  show_text("Closes these hints for good.");
  ImGui::End();
  return is_done;
}

} // namespace nendo::viewer
