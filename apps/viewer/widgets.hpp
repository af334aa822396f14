#pragma once
// Helpers for ImGui that every window uses.

#include "viewer/imgui_input.hpp"

namespace nendo::viewer {

/// Returns whether the key, by GLFW's number, has just gone down. With `repeats`, a key that is
/// held down counts again at intervals.
inline bool pressed(int key, bool repeats = false) {
  const auto known = imgui_key(key);
#if IMGUI_VERSION_NUM < 18700
  if (known < 0) return false;
#else
  if (known == ImGuiKey_None) return false;
#endif
  return ImGui::IsKeyPressed(known, repeats);
}

/// Returns whether keys are meant for the window: no text is being entered, and no question or list
/// is open.
inline bool takes_keys() {
  return !ImGui::GetIO().WantTextInput && !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
}

/// Begins a question in the middle of the window. If it returns true, the question's buttons and
/// ImGui::EndPopup() must follow.
inline bool begin_question(const char* title) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(all.x / 2.0F, all.y / 2.0F), ImGuiCond_Appearing,
                          ImVec2(0.5F, 0.5F));
  return ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize);
}

} // namespace nendo::viewer
