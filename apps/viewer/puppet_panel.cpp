// The part of the live window's panel that edits a puppet, and its keys.

#include <algorithm>
#include <array>
#include <string>

#include <nendo/hand/skeleton.hpp>

#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/panel.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {
namespace {

/// The fingers of both hands, of which one is to be chosen.
void choose_finger(PuppetEditor& editor) {
  const std::size_t function = editor.function();
  const bool is_pending = editor.pending().has_value();
  const std::string now = is_pending || function == PuppetEditor::none
                              ? "choose a finger"
                              : editor.rig().puppet().functions[function].input.name();
  ImGui::SetNextItemWidth(-1.0F);
  const bool is_open = ImGui::BeginCombo("##finger", now.c_str());
  show_text("The finger that moves the new point, or the chosen function.");
  if (!is_open) return;
  for (const Side side : {Side::left, Side::right})
    for (std::size_t finger = 0; finger < hand::finger_count; ++finger) {
      const auto signal = puppet::HandSignal::numbered(side, static_cast<std::uint8_t>(finger));
      if (signal && ImGui::Selectable(signal->name().c_str(), signal->name() == now))
        editor.choose_input(*signal, puppet::BendWatch::usual_rad(finger));
    }
  ImGui::EndCombo();
}

void list_functions(PuppetEditor& editor) {
  const auto& functions = editor.rig().puppet().functions;
  if (functions.empty()) return;
  ImGui::BeginChild("functions", ImVec2(0.0F, em(6.0F)), true);
  for (std::size_t at = 0; at < functions.size(); ++at) {
    const std::string words = functions[at].name + ": " + functions[at].input.name();
    if (ImGui::Selectable(words.c_str(), at == editor.function())) editor.choose_function(at);
    show_text("A function, and the finger that plays it; a click chooses it.");
  }
  ImGui::EndChild();
}

void name_function(PuppetEditor& editor) {
  const std::size_t function = editor.function();
  if (function == PuppetEditor::none) return;
  std::array<char, 65> name{};
  const std::string& now = editor.rig().puppet().functions[function].name;
  std::copy_n(now.begin(), std::min(now.size(), name.size() - 1), name.begin());
  ImGui::SetNextItemWidth(-1.0F);
  ImGui::InputText("##name", name.data(), name.size());
  show_text("The function's name; ARKit's are known to other programs.");
  if (ImGui::IsItemDeactivatedAfterEdit()) editor.rename_function(name.data());
}

} // namespace

void LiveWindow::Panel::puppet_buttons() {
  bool mirrors = editor.rig().puppet().mirrors;
  if (check("mirror", mirrors)) editor.toggle_mirror();
  show_help("mirror puppet");
  ImGui::SameLine();
  bool brushes = editor.brushes();
  if (check("brush masks", brushes)) editor.toggle_brush();
  show_help("paint masks", "Paint what stays; shift erases.");
  if (button("Pin")) editor.toggle_pin();
  show_help("pin point");
  ImGui::SameLine();
  if (button("Remove")) editor.remove_point();
  show_help("delete point");
  ImGui::SameLine();
  if (button("Save puppet")) commands.emplace_back(flow::SavePuppet{});
  show_help("save puppet");
}

void LiveWindow::Panel::describe_puppet(forms::Form& form, const flow::Frame& frame) {
  if (!form.section("Puppet", "What each finger moves, as points on the model.", true)) return;
  const bool is_on = editor.edits_puppet();
  if (button(is_on ? "Play the puppet" : "Edit the puppet", share_of_line(1))) editor.turn(!is_on);
  show_help("edit puppet", "Click, bend a finger, drag: what each finger does.");
  if (!editor.edits_puppet()) return;
  if (!editor.message().empty()) ImGui::TextWrapped("%s", editor.message().c_str());
  puppet_buttons();
  const double radius = editor.brushes() ? editor.brush_radius() : editor.radius();
  ImGui::Text("%s, radius %.1f cm", editor.brushes() ? "brush" : "point",
              100.0 * radius / frame.units_per_metre);
  show_text("How far it reaches (f, or the wheel over it).");
  choose_finger(editor);
  list_functions(editor);
  name_function(editor);
}

} // namespace nendo::viewer
