#include "viewer/row_button.hpp"

#include <string>
#include <utility>

#include <imgui.h>

namespace nendo::viewer {

template <class Now>
bool row_button(const commands::Row& row, const Now& now, float width) {
  const bool is_on = row.is_on_in(now) && !row.button_on.empty();
  const std::string text(is_on ? row.button_on : row.button);
  const bool possible = row.refusal_in(now) == nullptr;
  ImGui::BeginDisabled(!possible);
  const bool chosen = ImGui::Button(text.c_str(), ImVec2(width, 0.0F));
  ImGui::EndDisabled();
  show_help(row, now);
  return chosen && possible;
}
template bool row_button(const commands::Row&, const commands::Situation&, float);

template <class Now>
void show_help(const commands::Row& row, const Now& now) {
  const char* const refusal = row.refusal_in(now);
  std::string text(row.help);
  if (refusal != nullptr) text.append("\n").append(refusal);
  show_help(row.name, text);
}
template void show_help(const commands::Row&, const commands::Situation&);

void edit_buttons(commands::Buttons group, const commands::EditFacts& now, float width,
                  std::vector<commands::EditCommand>& asked) {
  bool is_first = true;
  for (const commands::Row& row : commands::table()) {
    if (row.group != group) continue;
    if (!std::exchange(is_first, false)) ImGui::SameLine();
    if (row_button(row, now, row.button_on.empty() ? width : 2.0F * width))
      asked.push_back(row.edit->command);
  }
}

void show_help(std::string_view name, std::string_view text) {
  if (!ImGui::IsItemHovered(ImGuiHoveredFlags_AllowWhenDisabled)) return;
  const commands::Row& row = *commands::named(name);
  const std::string shown =
      std::string(text.empty() ? row.help : text) + " (" + commands::keys_of(row) + ")";
  ImGui::SetTooltip("%s", shown.c_str());
}

} // namespace nendo::viewer
