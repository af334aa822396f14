#include "viewer/window_form.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <utility>

#include <imgui.h>

#include "forms/setting_pictures.hpp"
#include "viewer/command_widgets.hpp"
#include "viewer/controls.hpp"
#include "viewer/picture_card.hpp"
#include "viewer/theme.hpp"

namespace nendo::viewer {
namespace {

ImVec4 colour_of(forms::Form::Tone tone) {
  const ImGuiStyle& style = ImGui::GetStyle();
  switch (tone) {
  case forms::Form::Tone::faint:
    return style.Colors[ImGuiCol_TextDisabled];
  case forms::Form::Tone::warning:
    return warning();
  case forms::Form::Tone::success:
    return ImGui::ColorConvertU32ToFloat4(success_colour());
  default:
    return style.Colors[ImGuiCol_Text];
  }
}

void show_tip(std::string_view help) {
  if (!help.empty()) show_text(help);
}

} // namespace

unsigned success_colour(float opacity) {
  return ImGui::GetColorU32(is_dark() ? ImVec4(0.45F, 0.80F, 0.50F, opacity)
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
    width_ = share_of_line(in_line_);
  else
    ImGui::SameLine();
  return width_;
}

void WindowForm::separator() {
  lines_of(1);
  ImGui::Separator();
}

void WindowForm::text(std::string_view words, Tone tone, std::string_view help) {
  if (in_line_ == 0)
    next_width(words);
  else
    lines_of(in_line_);
  ImGui::PushTextWrapPos(0.0F);
  ImGui::PushStyleColor(ImGuiCol_Text, colour_of(tone));
  if (tone == Tone::title) ImGui::PushFont(large_font());
  ImGui::TextUnformatted(words.data(), words.data() + words.size());
  if (tone == Tone::title) ImGui::PopFont();
  ImGui::PopStyleColor();
  ImGui::PopTextWrapPos();
  note_control(words, "");
  show_tip(help);
}

void WindowForm::key(std::string_view words, const Eigen::Vector3f& colour) {
  const ImVec2 at = ImGui::GetCursorScreenPos();
  const float radius = em(0.32F);
  const Eigen::Vector3f seen = colour.array().pow(1.0F / 2.2F);
  ImGui::GetWindowDrawList()->AddCircleFilled(
      {at.x + radius, at.y + ImGui::GetTextLineHeight() / 2.0F}, radius,
      ImGui::GetColorU32({seen.x(), seen.y(), seen.z(), 1.0F}));
  ImGui::SetCursorScreenPos({at.x + em(1.0F), at.y});
  text(words);
}

void WindowForm::title(std::string_view words, std::string_view note) {
  lines_of(in_line_);
  ImGui::TextUnformatted(words.data(), words.data() + words.size());
  if (note.empty()) return;
  ImGui::SameLine();
  ImGui::TextDisabled("%.*s", static_cast<int>(note.size()), note.data());
}

bool WindowForm::section(std::string_view name, std::string_view help, bool is_open_at_first) {
  lines_of(1);
  return viewer::section(name, help, is_open_at_first);
}

void WindowForm::chart(std::string_view name, std::string_view help,
                       std::span<const float> values) {
  char words[64];
  const float most = *std::ranges::max_element(values);
  std::snprintf(words, sizeof words, "%.*s, most %.2f ms", static_cast<int>(name.size()),
                name.data(), static_cast<double>(most));
  ImGui::PushID(name.data(), name.data() + name.size());
  ImGui::PlotLines("##chart", values.data(), static_cast<int>(values.size()), 0, words, 0.0F,
                   std::max(1.0F, most), ImVec2(ImGui::GetContentRegionAvail().x, em(3.0F)));
  ImGui::PopID();
  show_tip(help);
}

void WindowForm::bends(Side side, std::string_view help, std::span<const float> degrees) {
  ImGui::PushID(static_cast<int>(side));
  ImGui::PlotHistogram("##joints", degrees.data(), static_cast<int>(degrees.size()), 0,
                       "thumb to little, degrees", 0.0F, 110.0F,
                       ImVec2(ImGui::GetContentRegionAvail().x, em(3.4F)));
  ImGui::PopID();
  show_tip(help);
}

bool WindowForm::button(std::string_view name, std::string_view help, Look look) {
  const float width = next_width(name);
  if (look == Look::done) ImGui::PushStyleColor(ImGuiCol_Button, success_colour(0.25F));
  const bool pressed = viewer::button(name, width, look != Look::grey, look == Look::chosen);
  if (look == Look::done) ImGui::PopStyleColor();
  show_tip(help);
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
  const bool pressed = picture_card(name, shown, ratio, width, is_chosen);
  show_tip(help);
  return pressed;
}

bool WindowForm::command(const commands::Row& row, const commands::State& now) {
  // A button in the line keeps its width when its label changes.
  const float share = next_width(row.button);
  const bool keeps = in_line_ == 0 && !row.button_on.empty();
  return row_button(row, now, keeps ? em(4.5F) : share);
}

bool WindowForm::box(std::string_view name, const commands::Row& row, const commands::State& now,
                     bool is_on) {
  const std::size_t in_line = std::max<std::size_t>(1, in_line_), column = at_++ % in_line;
  if (column == 0) {
    left_ = ImGui::GetCursorPosX();
    width_ = ImGui::GetContentRegionAvail().x / static_cast<float>(in_line);
  } else {
    ImGui::SameLine(left_ + static_cast<float>(column) * width_);
  }
  const bool changed = viewer::check(name, is_on);
  viewer::show_help(row, now);
  return changed;
}

bool WindowForm::check(std::string_view name, std::string_view help, bool& value) {
  if (in_line_ == 0) next_width(name);
  const bool changed = viewer::check(name, value);
  show_tip(help);
  return changed;
}

bool WindowForm::choice(std::string_view name, std::string_view help,
                        std::span<const std::string_view> names, std::size_t& chosen) {
  const bool changed = choice_field(name, names, chosen);
  show_tip(help);
  return changed;
}

bool WindowForm::one_of(std::string_view, std::span<const Choice> choices, std::size_t& chosen) {
  const std::size_t before = chosen;
  for (std::size_t at = 0; at < choices.size(); ++at) {
    const auto& [name, help, picture] = choices[at];
    if (picture_button(name, forms::line_picture(picture), next_width(name), at == before))
      chosen = at;
    show_tip(help);
  }
  return chosen != before;
}

bool WindowForm::number(std::string_view name, std::string_view help, float& value, float min,
                        float max, std::string_view unit, int decimals) {
  std::string format = "%." + std::to_string(decimals) + "f";
  if (!unit.empty()) format.append(" ").append(unit);
  bool changed = false;
  if (in_line_ == 0) {
    next_width(name);
    changed =
        bar_field(name, value, min, max, (std::string(name) + " " + format).c_str(), em(7.4F));
  } else {
    changed = number_field(name, value, min, max, format.c_str());
  }
  if (!help.empty())
    show_text(std::string(help) + "\nDrag, double click to type, or ctrl and the wheel.");
  return changed;
}

bool WindowForm::line(std::string_view name, std::string& value) {
  std::array<char, 512> text{};
  value.copy(text.data(), text.size() - 1);
  const bool changed = text_field(name, text);
  if (changed) value = text.data();
  return changed;
}

std::optional<std::size_t> WindowForm::list(std::string_view name, std::string_view help,
                                            std::span<const Row> rows, std::size_t present) {
  std::optional<std::size_t> clicked;
  const std::string id(name);
  const Shown now{rows.size(), present, rows.empty() ? "" : rows.back().text};
  const bool is_new = std::exchange(lists_[id], now) != now;
  ImGui::BeginChild(id.c_str(), ImVec2(0.0F, em(7.0F)), true);
  for (std::size_t at = 0; at < rows.size(); ++at) {
    const auto& [text, is_faint] = rows[at];
    ImGui::PushID(static_cast<int>(at));
    ImGui::PushStyleColor(ImGuiCol_Text, colour_of(is_faint ? Tone::faint : Tone::plain));
    if (ImGui::Selectable(text.c_str(), at == present)) clicked = at;
    ImGui::PopStyleColor();
    note_control(id + " " + std::to_string(at), text);
    show_tip(help);
    if (at == present && is_new) ImGui::SetScrollHereY(0.5F);
    ImGui::PopID();
  }
  ImGui::EndChild();
  return clicked;
}

forms::Pointer WindowForm::drawing(std::string_view name, std::string_view help,
                                   const forms::Drawing& drawing) {
  lines_of(1);
  auto& drawn = drawings_[std::string(name)];
  const forms::Pointer pointer = drawn.draw(name, drawing);
  show_tip(drawing.tooltip.empty() ? help : drawing.tooltip);
  return pointer;
}

bool WindowForm::is_changing() const {
  return ImGui::IsMouseDown(ImGuiMouseButton_Left);
}

} // namespace nendo::viewer
