#pragma once
// What every window's widgets need of ImGui.

#include "imgui_input.hpp"

namespace nendo::viewer {

/// Whether a key, by GLFW's number, goes down now; repeats: or is held down, now and then.
inline bool pressed(int key, bool repeats = false) {
  const auto known = imgui_key(key);
#if IMGUI_VERSION_NUM < 18700
  if (known < 0) return false;
#else
  if (known == ImGuiKey_None) return false;
#endif
  return ImGui::IsKeyPressed(known, repeats);
}

/// Whether keys are the window's: nobody writes, and no question or list is open.
inline bool takes_keys() {
  return !ImGui::GetIO().WantTextInput && !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
}

/// A question in the window's middle, if it is open: then its buttons follow, and
/// ImGui::EndPopup().
inline bool begin_question(const char* title) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(all.x / 2.0F, all.y / 2.0F), ImGuiCond_Appearing,
                          ImVec2(0.5F, 0.5F));
  return ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize);
}

} // namespace nendo::viewer
