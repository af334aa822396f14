#include "studio/window_form.hpp"

#include <array>

#include <imgui.h>

#include "viewer/controls.hpp"
#include "viewer/picture_card.hpp"
#include "viewer/theme.hpp"

namespace nendo::studio {
namespace {

ImVec4 colour_of(Form::Tone tone) {
  const ImGuiStyle& style = ImGui::GetStyle();
  switch (tone) {
  case Form::Tone::faint:
    return style.Colors[ImGuiCol_TextDisabled];
  case Form::Tone::warning:
    return viewer::warning();
  case Form::Tone::success:
    return ImGui::ColorConvertU32ToFloat4(success_colour());
  default:
    return style.Colors[ImGuiCol_Text];
  }
}

void show_help(std::string_view help) {
  if (!help.empty()) viewer::show_text(help);
}

} // namespace

unsigned success_colour(float opacity) {
  return ImGui::GetColorU32(viewer::is_dark() ? ImVec4(0.45F, 0.80F, 0.50F, opacity)
                                              : ImVec4(0.10F, 0.48F, 0.18F, opacity));
}

void WindowForm::lines_of(std::size_t count) {
  in_line_ = count;
  at_ = 0;
}

/// Begins the next button or card, in the same line if it fits. Returns its width.
float WindowForm::next_width(std::string_view name) {
  if (in_line_ == 0) {
    const ImGuiStyle& style = ImGui::GetStyle();
    const float width =
        ImGui::CalcTextSize(name.data(), name.data() + name.size()).x + 2.0F * style.FramePadding.x;
    const float right = ImGui::GetWindowPos().x + ImGui::GetWindowContentRegionMax().x;
    if (at_++ > 0 && ImGui::GetItemRectMax().x + style.ItemSpacing.x + width <= right)
      ImGui::SameLine();
    return 0.0F;
  }
  if (at_++ % in_line_ == 0)
    width_ = viewer::share_of_line(in_line_);
  else
    ImGui::SameLine();
  return width_;
}

void WindowForm::separator() {
  lines_of(1);
  ImGui::Separator();
}

void WindowForm::text(std::string_view words, Tone tone) {
  lines_of(in_line_);
  ImGui::PushTextWrapPos(0.0F);
  ImGui::PushStyleColor(ImGuiCol_Text, colour_of(tone));
  if (tone == Tone::title) ImGui::PushFont(viewer::large_font());
  ImGui::TextUnformatted(words.data(), words.data() + words.size());
  if (tone == Tone::title) ImGui::PopFont();
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  viewer::note_control(words, "");
}

void WindowForm::key(std::string_view words, const Eigen::Vector3f& colour) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float radius = viewer::em(0.32F);
  const Eigen::Vector3f seen = colour.array().pow(1.0F / 2.2F);
  ImGui::GetWindowDrawList()->AddCircleFilled(
      {at.x + radius, at.y + ImGui::GetTextLineHeight() / 2.0F}, radius,
      ImGui::GetColorU32({seen.x(), seen.y(), seen.z(), 1.0F}));
  ImGui::SetCursorScreenPos({at.x + viewer::em(1.0F), at.y});
  text(words);
}

void WindowForm::title(std::string_view words, std::string_view note) {
  lines_of(in_line_);
  ImGui::TextUnformatted(words.data(), words.data() + words.size());
  if (note.empty()) return;
  ImGui::SameLine();
  ImGui::TextDisabled("%.*s", static_cast<int>(note.size()), note.data());
}

bool WindowForm::button(std::string_view name, std::string_view help, Look look) {
  const float width = next_width(name);
  if (look == Look::done) ImGui::PushStyleColor(ImGuiCol_Button, success_colour(0.25F));
  const bool pressed = viewer::button(name, width, look != Look::grey, look == Look::chosen);
  if (look == Look::done) ImGui::PopStyleColor();
  show_help(help);
  return pressed;
}

bool WindowForm::card(std::string_view name, const render::Image* picture, std::string_view help,
                      bool is_chosen) {
  constexpr float ratio = 4.0F / 3.0F;
  const float width = next_width(name);
  gl::Picture* shown = nullptr;
  if (picture != nullptr) {
    auto& known = pictures_[picture];
    if (!known) known = std::make_unique<gl::Picture>(*picture);
    shown = known.get();
  }
  const bool pressed = viewer::picture_card(name, shown, ratio, width, is_chosen);
  show_help(help);
  return pressed;
}

bool WindowForm::check(std::string_view name, std::string_view help, bool& value) {
  const bool changed = viewer::check(name, value);
  show_help(help);
  return changed;
}

bool WindowForm::choice(std::string_view name, std::string_view help,
                        std::span<const std::string_view> names, std::size_t& chosen) {
  const bool changed = viewer::choice_field(name, names, chosen);
  show_help(help);
  return changed;
}

bool WindowForm::number(std::string_view name, std::string_view help, float& value, float min,
                        float max, std::string_view unit) {
  const std::string format = "%.0f " + std::string(unit);
  const bool changed = viewer::number_field(name, value, min, max, format.c_str());
  show_help(help);
  return changed;
}

bool WindowForm::line(std::string_view name, std::string& value) {
  std::array<char, 512> text{};
  value.copy(text.data(), text.size() - 1);
  const bool changed = viewer::text_field(name, text);
  if (changed) value = text.data();
  return changed;
}

} // namespace nendo::studio
