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
    KeyLine{"?", "this list"},
};

} // namespace

void draw_key_list(std::span<const KeyLine> own, const char* mouse, bool& shown) {
  ImGui::Begin("Keys", &shown, ImGuiWindowFlags_AlwaysAutoResize);
  for (const auto keys : {own, std::span<const KeyLine>(common_keys)})
    for (const KeyLine& line : keys)
      ImGui::Text("%-13s %s", line.key, line.does);
  ImGui::TextUnformatted("mouse: drag turns, middle or shift drag shifts, wheel zooms;");
  ImGui::TextUnformatted(mouse);
  ImGui::End();
}

} // namespace nendo::viewer
