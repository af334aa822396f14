#include "viewer/quick_input.hpp"

#include <cstddef>
#include <utility>

#include "viewer/imgui_input.hpp"

namespace nendo::viewer {
namespace {

constexpr std::size_t max_waiting = 64; // of somebody who leans on the keyboard

} // namespace

void QuickInput::press(int key, bool control, bool shift) {
  if (key >= GLFW_KEY_LEFT_SHIFT && key <= GLFW_KEY_RIGHT_SUPER) return; // come with the others
  if (waiting_.size() < max_waiting) waiting_.push_back({key, control, shift});
}

void QuickInput::click() noexcept {
  if (!clicked_) clicked_ = pointer_;
}

void QuickInput::put() {
  const ImGuiIO& io = ImGui::GetIO();
  if (const auto place = std::exchange(clicked_, {})) put_pointer(place->x, place->y);
  const int before = std::exchange(last_, 0);
  while (!waiting_.empty()) {
    const Tap tap = waiting_.front();
    if (tap.key == before) return; // tapped twice: it is seen to go up in between
    waiting_.pop_front();
    if (is_key_down(tap.key)) continue; // it still is down, and ImGui sees that
    beside_ = {tap.key, io.KeyCtrl, io.KeyShift};
    put_key(tap.key, true);
    put_modifiers(tap.control, tap.shift);
    last_ = tap.key;
    return;
  }
}

void QuickInput::take_back() {
  if (!beside_) return;
  put_key(beside_->key, false);
  put_modifiers(beside_->control, beside_->shift);
  beside_.reset();
}

} // namespace nendo::viewer
