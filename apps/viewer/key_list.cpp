#include "viewer/key_list.hpp"

#include <array>

#include <imgui.h>

namespace nendo::viewer {
namespace {

constexpr std::array common_keys{
    KeyLine{"h", "hands' skin on and off"},
    KeyLine{"b", "bones on and off"},
    KeyLine{"v", "control vectors on and off"},
    KeyLine{"d", "radii on and off"},
    KeyLine{"f", "facets in place of smooth shading"},
    KeyLine{"1, 3, 7", "the view from the front, the right, the top"},
    KeyLine{"ctrl 1, 3, 7", "from the back, the left, the bottom"},
    KeyLine{"?", "this list"},
};

} // namespace

void draw_key_list(std::span<const KeyLine> own, const char* mouse, bool& shown) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(all.x / 2.0F, all.y / 2.0F), ImGuiCond_Appearing,
                          ImVec2(0.5F, 0.5F));
  ImGui::Begin("Keys", &shown, ImGuiWindowFlags_AlwaysAutoResize);
  for (const auto keys : {own, std::span<const KeyLine>(common_keys)})
    for (const KeyLine& line : keys)
      ImGui::Text("%-13s %s", line.key, line.does);
  ImGui::TextUnformatted("mouse: drag turns, middle or shift drag shifts, wheel zooms;");
  ImGui::TextUnformatted(mouse);
  ImGui::End();
}

} // namespace nendo::viewer
