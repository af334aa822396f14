#include "viewer/key_list.hpp"

#include <string>

#include <imgui.h>

#include "commands/commands.hpp"

namespace nendo::viewer {

void draw_key_list(std::uint8_t places, const char* mouse, bool& shown) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(all.x / 2.0F, all.y / 2.0F), ImGuiCond_Appearing,
                          ImVec2(0.5F, 0.5F));
  ImGui::Begin("Keys", &shown, ImGuiWindowFlags_AlwaysAutoResize);
  for (const commands::Row& row : commands::table())
    if ((row.places & places) != 0)
      ImGui::Text("%-22s %s", commands::keys_of(row).c_str(), std::string(row.help).c_str());
  ImGui::TextUnformatted("A capital is typed with shift.");
  ImGui::TextUnformatted("mouse: drag turns, middle or shift drag shifts, wheel zooms;");
  ImGui::TextUnformatted(mouse);
  ImGui::End();
}

} // namespace nendo::viewer
