#include "viewer/command_search.hpp"

#include <algorithm>
#include <string>

#include <nendo/base/endings.hpp>

#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/theme.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {
namespace {

constexpr const char* title = "Search commands";

} // namespace

bool fits(const commands::Row& row, std::string_view text) {
  const std::string in =
      to_lower(std::string(row.name) + " " + std::string(row.button) + " " + std::string(row.help));
  const std::string wanted = to_lower(std::string(text));
  for (std::size_t at = 0; at < wanted.size();) {
    const std::size_t end = std::min(wanted.find(' ', at), wanted.size());
    if (in.find(wanted.substr(at, end - at)) == std::string::npos) return false;
    at = end + 1;
  }
  return true;
}

const commands::Row* CommandSearch::draw(std::uint8_t places, const commands::State& now,
                                         const char* mouse) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(0.5F * all.x, 0.2F * all.y), ImGuiCond_Appearing,
                          ImVec2(0.5F, 0.0F));
  ImGui::SetNextWindowSize(ImVec2(std::min(em(42.0F), all.x), 0.0F));
  if (!ImGui::BeginPopup(title)) return nullptr;
  if (ImGui::IsWindowAppearing()) ImGui::SetKeyboardFocusHere();
  ImGui::SetNextItemWidth(-1.0F);
  const bool is_entered =
      ImGui::InputTextWithHint("##search", "name of a command", text_.data(), text_.size(),
                               ImGuiInputTextFlags_EnterReturnsTrue);
  std::vector<const commands::Row*> found;
  for (const commands::Row& row : commands::table())
    if ((row.places & places) != 0 && fits(row, text_.data())) found.push_back(&row);
  if (pressed(GLFW_KEY_DOWN, true)) ++chosen_;
  if (pressed(GLFW_KEY_UP, true) && chosen_ > 0) --chosen_;
  chosen_ = found.empty() ? 0 : std::min(chosen_, found.size() - 1);
  const commands::Row* taken = is_entered && !found.empty() ? found[chosen_] : nullptr;
  ImGui::BeginChild("found", ImVec2(0.0F, em(18.0F)));
  for (std::size_t at = 0; at < found.size(); ++at) {
    const commands::Row& row = *found[at];
    const bool is_possible = row.refusal_in(now) == nullptr;
    if (ImGui::Selectable((std::string(row.name) + "##row").c_str(), at == chosen_,
                          is_possible ? 0 : ImGuiSelectableFlags_Disabled))
      taken = &row;
    note_control("found " + std::string(row.name), "");
    show_help(row, now);
    if (at == chosen_ && ImGui::IsWindowAppearing()) ImGui::SetScrollHereY();
    ImGui::SameLine(em(9.0F));
    ImGui::TextDisabled("%s", commands::keys_of(row).c_str());
    ImGui::SameLine(em(18.5F));
    ImGui::TextDisabled("%s", std::string(row.help).c_str());
  }
  ImGui::EndChild();
  ImGui::TextDisabled("A capital is typed with shift.\n"
                      "mouse: drag turns, middle or shift drag shifts, wheel zooms;\n%s",
                      mouse);
  if (taken != nullptr || pressed(GLFW_KEY_ESCAPE)) ImGui::CloseCurrentPopup();
  ImGui::EndPopup();
  return taken;
}

std::vector<const commands::Row*>
CommandSearch::asked(std::uint8_t places, const commands::State& now, const char* mouse) {
  std::vector<const commands::Row*> rows;
  if (takes_keys())
    for (const commands::Row& row : commands::table())
      if ((row.places & places) != 0 && is_struck(row)) rows.push_back(&row);
  if (const commands::Row* const found = draw(places, now, mouse)) rows.push_back(found);
  for (const commands::Row* const row : rows)
    if (row->name == "search" || row->name == "list keys") {
      text_ = {};
      chosen_ = 0;
      ImGui::OpenPopup(title);
    }
  return rows;
}
} // namespace nendo::viewer
