#include "quick_input.hpp"

#include <cstddef>
#include <utility>

#include <GLFW/glfw3.h>
#include <imgui.h>

namespace nendo::viewer {
namespace {

constexpr std::size_t most_waiting = 64; // of somebody who leans on the keyboard

} // namespace

void QuickInput::press(int key, bool control, bool shift) {
  if (key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER) return; // come with the others
  if (key <= 0 || key >= IM_ARRAYSIZE(ImGui::GetIO().KeysDown)) return;
  if (waiting_.size() < most_waiting) waiting_.push_back({key, control, shift});
}

void QuickInput::click() noexcept {
  if (!clicked_) clicked_ = pointer_;
}

void QuickInput::put() {
  ImGuiIO& io = ImGui::GetIO();
  if (const auto place = std::exchange(clicked_, {})) io.MousePos = {place->x, place->y};
  const int before = std::exchange(last_, 0);
  while (!waiting_.empty()) {
    const Tap tap = waiting_.front();
    if (tap.key == before) return; // tapped twice: it is seen to go up in between
    waiting_.pop_front();
    if (io.KeysDown[tap.key]) continue; // it still is down, and ImGui sees that
    beside_ = {tap.key, io.KeyCtrl, io.KeyShift};
    io.KeysDown[tap.key] = true;
    io.KeyCtrl = tap.control;
    io.KeyShift = tap.shift;
    last_ = tap.key;
    return;
  }
}

void QuickInput::take_back() {
  if (!beside_) return;
  ImGuiIO& io = ImGui::GetIO();
  io.KeysDown[beside_->key] = false;
  io.KeyCtrl = beside_->control;
  io.KeyShift = beside_->shift;
  beside_.reset();
}

} // namespace nendo::viewer
