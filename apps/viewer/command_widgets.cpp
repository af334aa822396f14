#include "viewer/command_widgets.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "viewer/controls.hpp"
#include "viewer/widgets.hpp"

namespace nendo::viewer {
namespace {

constexpr std::array<std::pair<std::string_view, int>, 13> named_keys{{
    {"Tab", GLFW_KEY_TAB},
    {"Esc", GLFW_KEY_ESCAPE},
    {"Delete", GLFW_KEY_DELETE},
    {"Backspace", GLFW_KEY_BACKSPACE},
    {"Home", GLFW_KEY_HOME},
    {"End", GLFW_KEY_END},
    {"Space", GLFW_KEY_SPACE},
    {"Left", GLFW_KEY_LEFT},
    {"Right", GLFW_KEY_RIGHT},
    {"Up", GLFW_KEY_UP},
    {"Down", GLFW_KEY_DOWN},
    {"?", GLFW_KEY_SLASH},
    {"F3", GLFW_KEY_F3},
}};

bool take_prefix(std::string_view& name, std::string_view prefix) noexcept {
  if (!name.starts_with(prefix)) return false;
  name.remove_prefix(prefix.size());
  return true;
}

bool is_letter(int key) noexcept {
  return key >= GLFW_KEY_A && key <= GLFW_KEY_Z;
}

} // namespace

bool KeyStroke::fits(bool with_control, bool with_shift) const noexcept {
  return control == with_control && (shift == with_shift || !is_letter(key));
}

// GLFW's numbers of letters, digits and signs are ASCII's, of letters those of capitals.
KeyStroke stroke_of(std::string_view name) noexcept {
  KeyStroke stroke;
  stroke.control = take_prefix(name, "Ctrl ");
  stroke.shift = take_prefix(name, "Shift ");
  const auto* const found = std::find_if(named_keys.begin(), named_keys.end(),
                                         [&](const auto& one) { return one.first == name; });
  if (found != named_keys.end()) {
    stroke.key = found->second;
  } else if (name.size() == 1) {
    const char c = name.front();
    const bool is_small = c >= 'a' && c <= 'z';
    stroke.key = is_small ? c - 'a' + GLFW_KEY_A : c;
    stroke.shift = stroke.shift || (is_letter(c) && !stroke.control);
  }
  return stroke;
}

bool is_struck(const commands::Row& row) {
  const ImGuiIO& io = ImGui::GetIO();
  return std::any_of(row.keys.begin(), row.keys.end(), [&](std::string_view name) {
    const KeyStroke stroke = stroke_of(name);
    return stroke.key != 0 && stroke.fits(io.KeyCtrl, io.KeyShift) &&
           pressed(stroke.key, row.repeats);
  });
}

bool row_button(const commands::Row& row, const commands::State& now, float width) {
  const bool is_on = row.is_on_in(now) && !row.button_on.empty();
  const bool chosen =
      button(is_on ? row.button_on : row.button, width, row.refusal_in(now) == nullptr);
  show_help(row, now);
  return chosen;
}

void show_help(const commands::Row& row, const commands::State& now) {
  show_text(commands::help_of(row, now));
}

void show_help(std::string_view name, std::string_view text) {
  const commands::Row& row = *commands::named(name);
  show_text(std::string(text.empty() ? row.help : text) + " (" + commands::keys_of(row) + ")");
}

} // namespace nendo::viewer
