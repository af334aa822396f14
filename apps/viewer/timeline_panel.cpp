#include "viewer/timeline_panel.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "commands/commands.hpp"
#include "viewer/key_list.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {
namespace {

constexpr const char* question = "Unsaved changes";

constexpr std::array timeline_key_table{
    KeyLine{"space", "play, or pause"},
    KeyLine{"left, right", "a frame back, on"},
    KeyLine{"up, down", "to the key before, to the next"},
    KeyLine{"Home, End", "to the beginning, to the end"},
    KeyLine{"- =", "slower, faster"},
    KeyLine{"l", "loop on and off"},
    KeyLine{"a", "add a key at the play head"},
    KeyLine{"x, Delete", "delete the selected key"},
    KeyLine{"c", "copy the selected key to the play head"},
    KeyLine{"m", "mirror: each hand does what the other did"},
    KeyLine{"ctrl z", "undo; with shift, or ctrl y: redo"},
    KeyLine{"ctrl s", "save"},
    KeyLine{"e", "export as .glb"},
    KeyLine{"Esc", "give up a drag; select nothing"},
    KeyLine{"q", "quit"},
};
constexpr const char* mouse_words =
    "drag on the strip scrubs, wheel zooms it, middle drag shifts it;\n"
    "a key: click selects, drag moves, ctrl drag copies;\n"
    "a ringed fingertip: drag bends the finger, with the wheel\n"
    "away and back";

struct Shortcut {
  int key;
  EditCommand command;
};
constexpr std::array shortcuts{
    Shortcut{GLFW_KEY_SPACE, EditCommand::play},
    Shortcut{GLFW_KEY_UP, EditCommand::previous_key},
    Shortcut{GLFW_KEY_DOWN, EditCommand::next_key},
    Shortcut{GLFW_KEY_HOME, EditCommand::to_begin},
    Shortcut{GLFW_KEY_END, EditCommand::to_end},
    Shortcut{GLFW_KEY_A, EditCommand::add_key},
    Shortcut{GLFW_KEY_X, EditCommand::delete_key},
    Shortcut{GLFW_KEY_DELETE, EditCommand::delete_key},
    Shortcut{GLFW_KEY_C, EditCommand::copy_key},
    Shortcut{GLFW_KEY_M, EditCommand::mirror},
    Shortcut{GLFW_KEY_E, EditCommand::export_glb},
};

// True: pressed, and it can be.
bool button(const char* words, bool possible) {
  ImGui::BeginDisabled(!possible);
  const bool chosen = ImGui::Button(words);
  ImGui::EndDisabled();
  return chosen && possible;
}

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

void TimelineWindow::Panel::file(const TimelineView& view, EditActions& actions) const {
  const std::string name = std::filesystem::path(view.file).filename().string();
  ImGui::Text("%s%s   (? for keys)", name.c_str(), view.modified ? " *" : "");
  const auto ask = [&](const char* words, bool possible, EditCommand command) {
    if (button(words, possible)) actions.commands.push_back(command);
    ImGui::SameLine();
  };
  ask("Undo", view.can_undo, EditCommand::undo);
  ask("Redo", view.can_redo, EditCommand::redo);
  ask("Save", view.modified, EditCommand::save);
  if (button(view.exporting ? "Exporting" : "Export .glb", !view.exporting))
    actions.commands.push_back(EditCommand::export_glb);
  if (ImGui::IsItemHovered()) ImGui::SetTooltip("as it is now, to %s", view.export_file.c_str());
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
  const auto ask = [&](const char* words, bool possible, EditCommand command) {
    if (button(words, possible)) actions.commands.push_back(command);
  };
  ask("Add at head", true, EditCommand::add_key);
  ImGui::SameLine();
  ask("Copy to head", any, EditCommand::copy_key);
  ImGui::SameLine();
  ask("Delete", any, EditCommand::delete_key);
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
  if (ImGui::Button("Mirror the hands")) actions.commands.push_back(EditCommand::mirror);
  if (retiming.to_s <= retiming.from_s) retiming.to_s = view.duration_s;
  seconds("from", retiming.from_s, view.head_s);
  seconds("to", retiming.to_s, view.head_s);
  ImGui::SetNextItemWidth(110.0F);
  ImGui::InputDouble("times as long", &retiming.scale, 0.0, 0.0, "%.3f");
  if (ImGui::Button("Retime")) actions.retiming = retiming;
}

void TimelineWindow::Panel::keys(const TimelineView& view, EditActions& actions) {
  const ImGuiIO& io = ImGui::GetIO();
  if (!takes_keys()) return;
  auto& commands = actions.commands;
  if (io.KeyCtrl) {
    if (pressed(GLFW_KEY_Z, true))
      commands.push_back(io.KeyShift ? EditCommand::redo : EditCommand::undo);
    if (pressed(GLFW_KEY_Y, true)) commands.push_back(EditCommand::redo);
    if (pressed(GLFW_KEY_S)) commands.push_back(EditCommand::save);
    return;
  }
  for (const Shortcut& shortcut : shortcuts)
    if (pressed(shortcut.key)) commands.push_back(shortcut.command);
  if (pressed(GLFW_KEY_LEFT, true)) commands.push_back(EditCommand::previous_frame);
  if (pressed(GLFW_KEY_RIGHT, true)) commands.push_back(EditCommand::next_frame);
  constexpr double faster = 1.25;
  if (pressed(GLFW_KEY_MINUS, true)) actions.speed = view.speed / faster;
  if (pressed(GLFW_KEY_EQUAL, true)) actions.speed = view.speed * faster;
  if (pressed(GLFW_KEY_L)) actions.loops = !view.loops;
  if (pressed(GLFW_KEY_SLASH)) keys_shown = !keys_shown;
  if (pressed(GLFW_KEY_ESCAPE) && !actions.drop) actions.select.emplace();
  if (keys_shown) draw_key_list(timeline_key_table, commands::in_timeline, mouse_words, keys_shown);
}

void TimelineWindow::Panel::leave(const TimelineView& view, bool wanted, EditActions& actions) {
  const bool open = ImGui::IsPopupOpen(question);
  wanted = wanted || (takes_keys() && pressed(GLFW_KEY_Q));
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
