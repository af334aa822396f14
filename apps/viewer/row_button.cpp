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
  const char* const refusal = row.refusal_in(now);
  std::string text(row.help);
  if (refusal != nullptr) text.append("\n").append(refusal);
  show_help(row.name, text);
}

void show_help(std::string_view name, std::string_view text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const commands::Row& row = *commands::named(name);
  const std::string shown =
      std::string(text.empty() ? row.help : text) + " (" + commands::keys_of(row) + ")";
  ImGui::SetTooltip("%s", shown.c_str());
}

} // namespace nendo::viewer
