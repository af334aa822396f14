#pragma once
// ImGui helpers for all windows, and input by GLFW's key numbers. Before version 1.87, a program
// writes the state of keys and pointer into ImGuiIO. Since 1.87, ImGui has its own key numbers and
// queues events, which NewFrame() applies. Main thread.

#include <array>
#include <utility>

#include <Eigen/Core>
#include <GLFW/glfw3.h>
#include <imgui.h>

namespace nendo::viewer {

/// Since version 1.87, ImGui handles press and release in separate frames, also for short presses.
/// Then the back end's events need no workaround.
inline constexpr bool imgui_queues_events = IMGUI_VERSION_NUM >= 18700;

#if IMGUI_VERSION_NUM < 18700

inline constexpr int no_imgui_key = -1;

inline int imgui_key(int key) {
  return key > 0 && key < IM_ARRAYSIZE(ImGui::GetIO().KeysDown) ? key : no_imgui_key;
}

inline void put_key(int key, bool down) {
  if (const int known = imgui_key(key); known != no_imgui_key)
    ImGui::GetIO().KeysDown[known] = down;
}

inline void put_modifiers(bool control, bool shift) {
  ImGui::GetIO().KeyCtrl = control;
  ImGui::GetIO().KeyShift = shift;
}

inline void put_pointer(float x, float y) {
  ImGui::GetIO().MousePos = {x, y};
}

inline void put_button(int button, bool down) {
  ImGui::GetIO().MouseDown[button] = down;
}

inline void put_wheel(float turns) {
  ImGui::GetIO().MouseWheel = turns;
}

#else

inline constexpr ImGuiKey no_imgui_key = ImGuiKey_None;

/// Returns no_imgui_key for keys that no window uses.
inline ImGuiKey imgui_key(int key) {
  if (key >= GLFW_KEY_A && key <= GLFW_KEY_Z)
    return static_cast<ImGuiKey>(ImGuiKey_A + (key - GLFW_KEY_A));
  if (key >= GLFW_KEY_0 && key <= GLFW_KEY_9)
    return static_cast<ImGuiKey>(ImGuiKey_0 + (key - GLFW_KEY_0));
  if (key >= GLFW_KEY_KP_0 && key <= GLFW_KEY_KP_9)
    return static_cast<ImGuiKey>(ImGuiKey_Keypad0 + (key - GLFW_KEY_KP_0));
  constexpr std::array others{std::pair{GLFW_KEY_SPACE, ImGuiKey_Space},
                              std::pair{GLFW_KEY_ESCAPE, ImGuiKey_Escape},
                              std::pair{GLFW_KEY_ENTER, ImGuiKey_Enter},
                              std::pair{GLFW_KEY_TAB, ImGuiKey_Tab},
                              std::pair{GLFW_KEY_DELETE, ImGuiKey_Delete},
                              std::pair{GLFW_KEY_BACKSPACE, ImGuiKey_Backspace},
                              std::pair{GLFW_KEY_LEFT, ImGuiKey_LeftArrow},
                              std::pair{GLFW_KEY_RIGHT, ImGuiKey_RightArrow},
                              std::pair{GLFW_KEY_UP, ImGuiKey_UpArrow},
                              std::pair{GLFW_KEY_DOWN, ImGuiKey_DownArrow},
                              std::pair{GLFW_KEY_HOME, ImGuiKey_Home},
                              std::pair{GLFW_KEY_END, ImGuiKey_End},
                              std::pair{GLFW_KEY_F3, ImGuiKey_F3},
                              std::pair{GLFW_KEY_MINUS, ImGuiKey_Minus},
                              std::pair{GLFW_KEY_EQUAL, ImGuiKey_Equal},
                              std::pair{GLFW_KEY_SLASH, ImGuiKey_Slash},
                              std::pair{GLFW_KEY_COMMA, ImGuiKey_Comma},
                              std::pair{GLFW_KEY_PERIOD, ImGuiKey_Period},
                              std::pair{GLFW_KEY_APOSTROPHE, ImGuiKey_Apostrophe},
                              std::pair{GLFW_KEY_SEMICOLON, ImGuiKey_Semicolon},
                              std::pair{GLFW_KEY_LEFT_BRACKET, ImGuiKey_LeftBracket},
                              std::pair{GLFW_KEY_RIGHT_BRACKET, ImGuiKey_RightBracket}};
  for (const auto& [number, known] : others)
    if (number == key) return known;
  return no_imgui_key;
}

inline void put_key(int key, bool down) {
  if (const ImGuiKey known = imgui_key(key); known != no_imgui_key)
    ImGui::GetIO().AddKeyEvent(known, down);
}

inline void put_modifiers(bool control, bool shift) {
  ImGui::GetIO().AddKeyEvent(ImGuiMod_Ctrl, control);
  ImGui::GetIO().AddKeyEvent(ImGuiMod_Shift, shift);
}

inline void put_pointer(float x, float y) {
  ImGui::GetIO().AddMousePosEvent(x, y);
}

inline void put_button(int button, bool down) {
  ImGui::GetIO().AddMouseButtonEvent(button, down);
}

inline void put_wheel(float turns) {
  if (turns != 0.0F) ImGui::GetIO().AddMouseWheelEvent(0.0F, turns);
}

#endif

inline bool is_key_down(int key) {
  const auto known = imgui_key(key);
  return known != no_imgui_key && ImGui::IsKeyDown(known);
}

/// Returns whether the key, by GLFW's number, was just pressed. With `repeats`, a key that is held
/// down repeats.
inline bool pressed(int key, bool repeats = false) {
  const auto known = imgui_key(key);
  return known != no_imgui_key && ImGui::IsKeyPressed(known, repeats);
}

/// Return where the pointer is, in pixels from the window's top left corner, and by how much it has
/// moved since the last picture.
inline Eigen::Vector2d pointer_px() {
  const ImVec2 at = ImGui::GetIO().MousePos;
  return {static_cast<double>(at.x), static_cast<double>(at.y)};
}
inline Eigen::Vector2d moved_px() {
  const ImVec2 by = ImGui::GetIO().MouseDelta;
  return {static_cast<double>(by.x), static_cast<double>(by.y)};
}

inline ImVec2 in_window(const Eigen::Vector2d& pixel) {
  return {static_cast<float>(pixel.x()), static_cast<float>(pixel.y())};
}

/// Returns whether keys are for the window: no text field, dialog or list is active.
inline bool takes_keys() {
  return !ImGui::GetIO().WantTextInput && !ImGui::IsPopupOpen(nullptr, ImGuiPopupFlags_AnyPopup);
}

/// Begins a window that stays where it is, as high as its contents. Its `corner`, from 0, 0 (top
/// left) to 1, 1, is at `at`. `most` is its width, 0: as its contents, and its max height. Returns
/// whether it is unfolded. ImGui::End() must follow.
inline bool begin_pane(const char* title, ImVec2 at, ImVec2 corner, ImVec2 most, int flags) {
  ImGui::SetNextWindowPos(at, ImGuiCond_Always, corner);
  if (most.x > 0.0F) ImGui::SetNextWindowSizeConstraints({most.x, 0.0F}, most);
  return ImGui::Begin(title, nullptr,
                      flags | ImGuiWindowFlags_AlwaysAutoResize | ImGuiWindowFlags_NoMove |
                          ImGuiWindowFlags_NoFocusOnAppearing);
}

/// Begins a modal dialog in the window's centre. If it returns true, the dialog's buttons and
/// ImGui::EndPopup() must follow.
inline bool begin_question(const char* title) {
  const ImVec2 all = ImGui::GetIO().DisplaySize;
  ImGui::SetNextWindowPos(ImVec2(all.x / 2.0F, all.y / 2.0F), ImGuiCond_Appearing,
                          ImVec2(0.5F, 0.5F));
  return ImGui::BeginPopupModal(title, nullptr, ImGuiWindowFlags_AlwaysAutoResize);
}

} // namespace nendo::viewer
