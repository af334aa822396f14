#include "viewer/row_button.hpp"

#include <string>

#include <imgui.h>

namespace nendo::viewer {

bool row_button(const commands::Row& row, const commands::Situation& now, float width) {
  const bool is_on = row.is_on_in(now) && !row.button_on.empty();
  const std::string text(is_on ? row.button_on : row.button);
  const bool possible = row.refusal_in(now) == nullptr;
  ImGui::BeginDisabled(!possible);
  const bool chosen = ImGui::Button(text.c_str(), ImVec2(width, 0.0F));
  ImGui::EndDisabled();
  show_help(row, now);
  return chosen && possible;
}

void show_help(const commands::Row& row, const commands::Situation& now) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const std::string help = std::string(row.help) + " (" + commands::keys_of(row) + ")";
  const char* const refusal = row.refusal_in(now);
  if (refusal != nullptr)
    ImGui::SetTooltip("%s\n%s", help.c_str(), refusal);
  else
    ImGui::SetTooltip("%s", help.c_str());
}

} // namespace nendo::viewer
