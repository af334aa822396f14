#include "viewer/timeline_panel.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "commands/commands.hpp"
#include "viewer/key_list.hpp"
#include "viewer/row_button.hpp"
#include "viewer/row_keys.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {
namespace {

constexpr const char* question = "Unsaved changes";

constexpr const char* mouse_words =
    "drag on the strip scrubs, wheel zooms it, middle drag shifts it;\n"
    "a key: click selects, drag moves, ctrl drag copies;\n"
    "a ringed fingertip: drag bends the finger, with the wheel\n"
    "away and back";

void seconds(const char* label, double& value_s, double head_s) {
  ImGui::PushID(label);
  ImGui::SetNextItemWidth(110.0F);
  ImGui::InputDouble(label, &value_s, 0.0, 0.0, "%.3f s");
  ImGui::SameLine();
  if (ImGui::SmallButton("= head")) value_s = head_s;
  ImGui::PopID();
}

} // namespace

void TimelineWindow::Panel::draw(const TimelineView& view, EditActions& actions) {
  constexpr float gap = gap_px;
  constexpr float panel_width = width_px;
  ImGui::SetNextWindowPos(ImVec2(gap, gap));
  ImGui::SetNextWindowSizeConstraints(ImVec2(panel_width, 0.0F), ImVec2(panel_width, 4096.0F));
  ImGui::Begin("Nendo: edit", nullptr, ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove);
  ImGui::PushTextWrapPos(panel_width - 12.0F);
  file(view, actions);
  if (ImGui::CollapsingHeader("Key", ImGuiTreeNodeFlags_DefaultOpen)) key(view, actions);
  if (!view.functions.empty() &&
      ImGui::CollapsingHeader("Functions", ImGuiTreeNodeFlags_DefaultOpen))
    functions(view);
  retiming_shown = ImGui::CollapsingHeader("Timeline");
  if (retiming_shown) whole(view, actions);
  if (!view.message.empty()) {
    ImGui::Separator();
    const ImVec4 colour =
        view.refused ? ImVec4(1.0F, 0.6F, 0.45F, 1.0F) : ImVec4(0.7F, 0.9F, 0.75F, 1.0F);
    ImGui::PushStyleColor(ImGuiCol_Text, colour);
    ImGui::TextUnformatted(view.message.c_str());
    ImGui::PopStyleColor();
  }
  ImGui::PopTextWrapPos();
  ImGui::End();
}

void TimelineWindow::Panel::file(const TimelineView& view, EditActions& actions) {
  const std::string name = std::filesystem::path(view.file).filename().string();
  ImGui::Text("%s%s   (? for keys)", name.c_str(), view.modified ? " *" : "");
  edit_buttons(commands::Buttons::file, view.facts, 0.0F, actions.commands);
}

void TimelineWindow::Panel::key(const TimelineView& view, EditActions& actions) {
  const bool any = view.selected.has_value();
  if (any) {
    const StripLane& lane = view.lanes[view.selected->lane];
    ImGui::Text("%s hand, key %zu of %zu, at %.3f s", std::string(name_of(lane.side)).c_str(),
                view.selected->key, lane.keys_s.size(), lane.keys_s[view.selected->key]);
  } else {
    ImGui::TextDisabled("click a key on the strip to select it");
  }
  edit_buttons(commands::Buttons::key, view.facts, 0.0F, actions.commands);
  ImGui::BeginDisabled(!any);
  ImGui::SetNextItemWidth(170.0F);
  if (ImGui::SliderFloat("blend", &blend, 0.0F, 1.0F, "%.2f")) {
    blends = true;
    actions.tried = KeyBlend{static_cast<double>(std::clamp(blend, 0.0F, 1.0F))};
  }
  ImGui::EndDisabled();
  if (ImGui::IsItemHovered())
    ImGui::SetTooltip("with its neighbours: what would be without it is 1");
  if (blends && !ImGui::IsMouseDown(ImGuiMouseButton_Left)) {
    actions.keep = true;
    blends = false;
    blend = 0.0F;
  }
  if (any)
    ImGui::TextDisabled("%s", view.at_selected
                                  ? "drag a ringed fingertip to bend its finger"
                                  : "the head is elsewhere: click the key to bend its fingers");
}

/// A bar for each, from 0; those below 0 are told by their numbers.
void TimelineWindow::Panel::functions(const TimelineView& view) {
  constexpr float bar_width = 90.0F;
  for (const FunctionValue& function : view.functions) {
    char number[32];
    std::snprintf(number, sizeof number, "%.2f", function.value);
    const auto part = static_cast<float>(std::clamp(std::abs(function.value), 0.0, 1.0));
    ImGui::ProgressBar(part, ImVec2(bar_width, 0.0F), number);
    ImGui::SameLine();
    ImGui::TextUnformatted(function.name.c_str());
  }
}

void TimelineWindow::Panel::whole(const TimelineView& view, EditActions& actions) {
  edit_buttons(commands::Buttons::whole, view.facts, 0.0F, actions.commands);
  if (retiming.to_s <= retiming.from_s) retiming.to_s = view.duration_s;
  seconds("from", retiming.from_s, view.head_s);
  seconds("to", retiming.to_s, view.head_s);
  ImGui::SetNextItemWidth(110.0F);
  ImGui::InputDouble("times as long", &retiming.scale, 0.0, 0.0, "%.3f");
  if (ImGui::Button("Retime")) actions.retiming = retiming;
}

void TimelineWindow::Panel::keys(SceneWindow& window, EditActions& actions) {
  if (takes_keys()) {
    window.follow_part_keys();
    window.follow_view_keys();
    for (const commands::Row& row : commands::table()) {
      if ((row.places & commands::in_timeline) == 0 || !is_struck(row)) continue;
      if (row.name == "list keys") keys_shown = !keys_shown;
      if (row.name == "frame all") window.frame_all();
      if (!row.edit) continue;
      const EditCommand asked = row.edit->command;
      // The same stroke of Esc has cancelled a drag.
      if (asked == EditCommand::select_none && actions.drop) continue;
      actions.commands.push_back(asked);
    }
  }
  if (keys_shown) draw_key_list(commands::in_timeline, mouse_words, keys_shown);
}

void TimelineWindow::Panel::leave(const TimelineView& view, bool wanted, EditActions& actions) {
  const bool open = ImGui::IsPopupOpen(question);
  wanted = wanted || (takes_keys() && is_struck(*commands::named("end edit")));
  if (wanted && !view.modified) actions.quit = true;
  if (wanted && view.modified && !open) ImGui::OpenPopup(question);
  if (!begin_question(question)) return;
  ImGui::Text("Save the changes to %s?", view.file.c_str());
  const bool save = ImGui::Button("Save and quit");
  ImGui::SameLine();
  const bool discard = ImGui::Button("Quit without saving");
  ImGui::SameLine();
  const bool stay = ImGui::Button("Stay") || pressed(GLFW_KEY_ESCAPE);
  if (save) actions.commands.push_back(EditCommand::save);
  actions.quit = actions.quit || save || discard;
  if (save || discard || stay) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
}

} // namespace nendo::viewer
